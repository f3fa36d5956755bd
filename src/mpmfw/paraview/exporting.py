"""Write a run for ParaView."""

from __future__ import annotations

import itertools
import json
import os
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pandas as pd
import xarray as xr

from mpmfw.errors import MpmfwError, ResultsWarning
from mpmfw.paraview.meshes import mesh_library, points_mesh, skipped_fields, surface_mesh
from mpmfw.results.domains import corners_of, surfaces_of
from mpmfw.results.replacing import check_new, replace_bytes, replacement
from mpmfw.results.selection import Results, bodies_of, chosen_frames, opened_run, rigid_bodies_of, times_of

#: Root attributes of a run that go into every file.
_ABOUT = ("title", "scene", "contact", "shape", "status", "commit", "versions")


def export(
    results: Results,
    target: str | os.PathLike[str],
    *,
    every: int = 1,
    bodies: Sequence[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
    force: bool = False,
) -> list[Path]:
    """Write a run for ParaView: VTK XML files, and collections with their times.

    Parameters
    ----------
    results
        A run's tree, or the name of its file, which is then read one output at a time.
    target
        Folder to write to, or the name of a ``.pvd`` file, whose folder and stem are taken.
    every, bodies
        Only each ``every``-th output, only these bodies.
    progress
        Called with the number of outputs written and that of all.
    force
        Replace an export that exists.

    Returns
    -------
    list of Path
        The files to open: ``…-points.pvd``, ``…-surfaces.pvd`` where surfaces are stored, ``…-series.csv``.

    Raises
    ------
    SceneError
        pyvista is missing, a file exists, or the results have no such body or no material points.
    MpmfwError
        A file cannot be read or written.
    """
    mesh_library()
    path = Path(target)
    if path.suffix == ".pvd":
        path = path.with_suffix("")
    else:
        path /= "run" if isinstance(results, xr.DataTree) else Path(results).stem
    try:
        with opened_run(results) as tree:
            return _export(tree, path, every, bodies, progress, force)
    except OSError as error:
        raise MpmfwError(f"cannot write '{error.filename or target}': {error.strerror or error}") from error


def _export(
    tree: xr.DataTree,
    target: Path,
    every: int,
    selection: Sequence[str] | None,
    progress: Callable[[int, int], None] | None,
    force: bool,
) -> list[Path]:
    chosen, frames = bodies_of(tree, selection), chosen_frames(tree, every)
    indices = {body: k for k, body in enumerate(bodies_of(tree)) if body in chosen}
    corners = {body: corners_of(tree, body) for body in indices}
    if names := skipped_fields(tree, chosen):
        warnings.warn(
            f"not exported, no scalar, vector or tensor of a point: {', '.join(names)}",
            ResultsWarning,
            stacklevel=3,
        )
    kinds: dict[str, Callable[[int], Any]] = {
        "points": lambda frame: points_mesh(tree, indices, corners, frame)
    }
    rigid = rigid_bodies_of(tree, selection)
    outlined = indices | {body: len(bodies_of(tree)) + k for k, body in enumerate(rigid)}
    if set(surfaces_of(tree)) & set(outlined):
        kinds["surfaces"] = lambda frame: surface_mesh(tree, outlined, frame)
    times = times_of(tree).tolist()
    folders = {kind: target.with_name(f"{target.name}-{kind}") for kind in kinds}
    written = [folder.with_name(f"{folder.name}.pvd") for folder in folders.values()]
    series = tree["series"].to_dataset() if "series" in tree.children else xr.Dataset()
    if series.data_vars:
        written.append(target.with_name(f"{target.name}-series.csv"))
    for file in written:
        check_new(file, force)
    for folder in folders.values():
        folder.mkdir(parents=True, exist_ok=True)
        for earlier in sorted(folder.glob("[0-9][0-9][0-9][0-9][0-9].vtu")):
            check_new(earlier, force).unlink()
    about = {name: str(tree.attrs[name]) for name in _ABOUT if tree.attrs.get(name)}
    about["bodies"] = json.dumps({str(index): body for body, index in outlined.items()})
    for done, index in enumerate(frames):
        for kind, mesh_of in kinds.items():
            grid = mesh_of(index)
            for name, text in about.items():
                grid.field_data[name] = [text]
            grid.field_data["TimeValue"] = np.array([times[index]])
            with replacement(folders[kind] / f"{index:05d}.vtu") as growing:
                grid.save(growing)
        if progress is not None:
            progress(done + 1, len(frames))
    for folder, collection in zip(folders.values(), written, strict=False):
        # last, so that the files they list are there
        _write_collection(collection, {f"{folder.name}/{i:05d}.vtu": times[i] for i in frames})
    if series.data_vars:
        _write_series(written[-1], series.isel(time=slice(None, None, every)).load())
    return written


def _write_collection(path: Path, times: dict[str, float]) -> None:
    root = ET.Element("VTKFile", type="Collection", version="0.1")
    collection = ET.SubElement(root, "Collection")
    for file, time in times.items():
        ET.SubElement(collection, "DataSet", timestep=repr(time), part="0", file=file)
    ET.indent(root)
    replace_bytes(ET.tostring(root, "utf-8", xml_declaration=True), path)


def _write_series(path: Path, series: xr.Dataset) -> None:
    """Write series as CSV, with columns such as ``centre_of_mass disc x [m]``."""
    columns: dict[str, Any] = {"time [s]": series["time"].values}
    for name, array in series.data_vars.items():
        if "time" not in array.dims:
            continue
        values, unit = array.transpose("time", ...), array.attrs.get("units", "1")
        labels = [map(str, array[dim].values) for dim in values.dims[1:]]
        heads = [" ".join((str(name), *choice)) for choice in itertools.product(*labels)]
        table = values.values.reshape(len(values), -1).astype(float)
        columns |= {f"{head} [{unit}]": column for head, column in zip(heads, table.T, strict=True)}
    replace_bytes(pd.DataFrame(columns).to_csv(index=False, na_rep="nan").encode(), path)
