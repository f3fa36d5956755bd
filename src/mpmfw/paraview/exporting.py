"""Write a run for ParaView: each output as meshes of material points and of surfaces, series as a table."""

from __future__ import annotations

import itertools
import json
import os
import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pandas as pd
import shapely
import xarray as xr

from mpmfw.errors import MpmfwError, ResultsWarning, SceneError
from mpmfw.results.domains import Corners, corners_of, facets_of, loops, surfaces_of
from mpmfw.results.fields import contact_fields
from mpmfw.results.replacing import check_new, replace_bytes, replacement
from mpmfw.results.selection import (
    Results,
    bodies_of,
    chosen_frames,
    frame_of,
    opened_run,
    rigid_bodies_of,
    times_of,
)
from mpmfw.state.fields import AnyArray, FloatArray, IntArray

#: Stored arrays that are the geometry of the mesh, not fields on it.
_GEOMETRY = ("position", "corners", "next", "triangles")

#: Out-of-plane component of tensors in plane strain, where it is known.
_ACROSS = {"deformation_gradient": 1.0, "velocity_gradient": 0.0, "affine": 0.0}


def mesh_library() -> Any:
    """Import pyvista; a SceneError says how to install it."""
    try:
        import pyvista
    except ImportError as error:
        raise SceneError("this needs pyvista: pip install 'mpmfw[render]'") from error
    return pyvista


def points_mesh(
    tree: xr.DataTree, bodies: Mapping[str, int], corners: Mapping[str, Corners | None], frame: int
) -> Any:
    """Return points of the ``bodies`` at one output, quadrilaterals if ``corners`` are known.

    As of surfaces, it is a pyvista.UnstructuredGrid that has the units of its fields in ``field_data``."""
    frames = {body: frame_of(tree, f"particles/{body}", frame) for body in bodies}
    points = _joined(frames, bodies, "particle")
    fields = _fields(points)
    kinds = mesh_library().CellType
    drawn = [of(frames[body]) for body in bodies if (of := corners[body]) is not None]
    if len(drawn) == len(bodies):
        nodes = np.concatenate(drawn)
        quads = np.arange(4 * len(nodes)).reshape(-1, 4)
        grid = _grid(nodes.reshape(-1, 2), kinds.QUAD, quads, points)
        grid.cell_data.update(fields)
    else:
        position = fields.pop("position")
        grid = _grid(position, kinds.VERTEX, np.arange(len(position))[:, np.newaxis], points)
        grid.point_data.update(fields)
        grid.cell_data["body"] = fields["body"]
    return grid


def surface_mesh(tree: xr.DataTree, bodies: Mapping[str, int], frame: int) -> Any:
    """Return surfaces of bodies at one output, with gap and contact fields."""
    everywhere = {body: frame_of(tree, f"surface/{body}", frame) for body in surfaces_of(tree)}
    shapes = {
        body: (np.asarray(data["position"].values, dtype=float), facets_of(tree, body))
        for body, data in everywhere.items()
    }
    frames = {body: data for body, data in everywhere.items() if body in bodies}
    for body, data in frames.items():
        position, facets = shapes[body]
        distances = distances_in_plane if facets.shape[1] == 2 else distances_in_space
        others = [distances(position, *shape) for other, shape in shapes.items() if other != body]
        nearest = np.min(others or [np.full(len(position), np.nan)], axis=0)
        gap = xr.DataArray(nearest, dims="surface_node", attrs={"units": "m"})
        pressed = contact_fields(tree, body, data) if "force" in data else {}
        frames[body] = data.assign({"gap": gap, **pressed})
    nodes = _joined(frames, bodies, "surface_node")
    fields = _fields(nodes)
    start = np.cumsum([0, *(frame.sizes["surface_node"] for frame in frames.values())])
    facets = np.concatenate([shapes[body][1] + first for body, first in zip(frames, start, strict=False)])
    kinds = mesh_library().CellType
    kind = kinds.LINE if facets.shape[1] == 2 else kinds.TRIANGLE
    grid = _grid(fields.pop("position"), kind, facets, nodes)
    grid.point_data.update(fields)
    grid.cell_data["body"] = fields["body"][facets[:, 0]]
    return grid


def distances_in_plane(points: FloatArray, nodes: FloatArray, segments: IntArray) -> FloatArray:
    """Return distances (n,) [m] of points (n, 2) from closed polylines of ``segments``, negative inside."""
    rings = [shapely.Polygon(nodes[loop]) for loop in loops(segments[:, 1])]
    outlines = shapely.MultiLineString([ring.exterior for ring in rings])
    shapely.prepare(rings)
    inside = np.logical_xor.reduce([shapely.contains_xy(ring, points) for ring in rings])
    distance = shapely.distance(outlines, shapely.points(points))
    return np.asarray(np.where(inside, -distance, distance))


def distances_in_space(points: FloatArray, nodes: FloatArray, facets: IntArray) -> FloatArray:
    """Return distances (n,) [m] of points (n, 3) from a closed surface, negative inside.

    On edges and nodes the angle-weighted normal decides (J. A. Bærentzen, H. Aanæs, 2005).
    """
    mesh: Any = mesh_library().PolyData  # its annotations lack integers of fixed width
    cloud = mesh(points).compute_implicit_distance(mesh.from_regular_faces(nodes, facets))
    return np.asarray(cloud["implicit_distance"])


def skipped_fields(tree: xr.DataTree, bodies: Sequence[str]) -> list[str]:
    """Return stored fields that are not scalars, vectors or tensors."""
    groups = [(f"particles/{body}", "particle") for body in bodies]
    groups += [(f"surface/{body}", "surface_node") for body in surfaces_of(tree)]
    frames = [(frame_of(tree, place, 0), dim) for place, dim in groups]
    names = [
        str(name) for frame, dim in frames for name in frame.data_vars if not _is_field(frame[name], dim)
    ]
    return [name for name in dict.fromkeys(names) if name not in _GEOMETRY]


def _joined(frames: Mapping[str, xr.Dataset], bodies: Mapping[str, int], dim: str) -> xr.Dataset:
    parts = []
    for body, frame in frames.items():
        fields = frame[[name for name in frame if name != "next" and _is_field(frame[name], dim)]]
        own = (dim, np.full(frame.sizes[dim], bodies[body]))
        parts.append(fields.drop_vars("body", errors="ignore").assign(body=own))
    return xr.concat(
        parts, dim, data_vars="all", coords="minimal", compat="override", combine_attrs="override"
    )


def _is_field(array: xr.DataArray, dim: str) -> bool:
    return array.dims in ((dim,), (dim, "axis"), (dim, "axis", "axis2"))


def _fields(points: xr.Dataset) -> dict[str, AnyArray]:
    """Return fields for VTK, vectors of 3 components and tensors of 9."""
    fields: dict[str, AnyArray] = {}
    for name, array in points.data_vars.items():
        values = array.values
        missing = 3 - values.shape[-1]
        values = np.pad(values, [(0, 0)] + [(0, missing)] * (values.ndim - 1))
        if values.ndim == 3:
            if missing:
                values[:, 2, 2] = _ACROSS.get(str(name), np.nan)
            values = values.reshape(-1, 9)
        fields[str(name)] = values
    return fields


def _grid(points: FloatArray, kind: int, cells: IntArray, fields: xr.Dataset) -> Any:
    points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    grid = mesh_library().UnstructuredGrid({kind: cells}, points)
    names = {str(name) for name in fields.data_vars} - {"body"}
    units = {name: str(fields[name].attrs.get("units", "1")) for name in sorted(names)}
    grid.field_data["units"] = [json.dumps(units)]
    return grid


#: Root attributes of a run that go into every file.
_ABOUT = ("title", "scene", "contact", "shape", "status", "commit", "versions")

#: Ranges that VTK stores beside an array; a NaN among them it cannot read.
_RANGES = re.compile(rb'\s*<InformationKey name="L2_NORM_.*?</InformationKey>', re.DOTALL)


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
        text = f"not exported, no scalar, vector or tensor of a point: {', '.join(names)}"
        warnings.warn(text, ResultsWarning, stacklevel=3)
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
                growing.write_bytes(_RANGES.sub(b"", growing.read_bytes()))
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
