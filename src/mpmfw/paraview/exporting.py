"""Write a run for ParaView."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from mpmfw.errors import MpmfwError, ResultsWarning
from mpmfw.paraview.files import Mesh, write_collection, write_mesh
from mpmfw.paraview.meshes import left_out, points_mesh, surface_mesh, surfaces_of, unit_of
from mpmfw.paraview.table import write_series
from mpmfw.results.domains import domains_of
from mpmfw.results.outputs import Results, attribute, bodies_of, chosen_frames, opened_run, times_of
from mpmfw.results.replacing import check_new

#: Root attributes of a run that go into every file.
_ABOUT = ("title", "scene", "contact", "shape", "status", "commit", "versions")


@dataclass(frozen=True)
class Target:
    """Where an export goes: a folder, and how the names in it begin."""

    folder: Path
    stem: str

    def collection(self, kind: str) -> Path:
        """The file that ParaView opens."""
        return self.folder / f"{self.stem}-{kind}.pvd"

    def frame(self, kind: str, index: int) -> Path:
        """The file of one output, which is called by its index in the results."""
        return self.folder / f"{self.stem}-{kind}" / f"{index:05d}.vtu"

    @property
    def series(self) -> Path:
        """The table of the series."""
        return self.folder / f"{self.stem}-series.csv"


def export(
    results: Results,
    target: str | os.PathLike[str],
    *,
    every: int = 1,
    bodies: Sequence[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
    force: bool = False,
) -> list[Path]:
    """Write a run for ParaView: VTK XML files of every output, and collections with their times.

    Parameters
    ----------
    results
        A run's tree, or the name of its file, which is then read one output at a time.
    target
        Folder to write to, made if it is not there; or the name of a ``.pvd`` file, whose folder and stem are
        taken.
    every
        Only each ``every``-th output, the first one included.
    bodies
        Only these bodies.
    progress
        Called with the number of outputs written and that of all.
    force
        Replace an export that exists.

    Returns
    -------
    list of Path
        What to open: ``…-points.pvd``, ``…-surfaces.pvd`` where surfaces are stored, ``…-series.csv``.

    Raises
    ------
    SceneError
        The results are not those of a run, hold no material points, have no such body, or a file to write exists.
    MpmfwError
        The file cannot be read, or a file cannot be written.
    """
    try:
        with opened_run(results) as tree:
            return _export(tree, _target(results, target), every, bodies, progress, force)
    except OSError as error:
        raise MpmfwError(f"cannot write '{error.filename or target}': {error.strerror or error}") from error


def _target(results: Results, target: str | os.PathLike[str]) -> Target:
    path = Path(target)
    if path.suffix == ".pvd":
        return Target(path.parent, path.stem)
    return Target(path, "run" if isinstance(results, xr.DataTree) else Path(results).stem)


def _export(
    tree: xr.DataTree,
    target: Target,
    every: int,
    selection: Sequence[str] | None,
    progress: Callable[[int, int], None] | None,
    force: bool,
) -> list[Path]:
    chosen, frames = bodies_of(tree, selection), chosen_frames(tree, every)
    indices = {body: k for k, body in enumerate(bodies_of(tree)) if body in chosen}
    domains = {body: domains_of(tree, body) for body in indices}
    _tell(left_out(tree, chosen))
    kinds: dict[str, Callable[[int], Mesh]] = {
        "points": lambda frame: points_mesh(tree, indices, domains, frame)
    }
    outlined = [body for body in surfaces_of(tree) if body in chosen]
    if outlined:
        kinds["surfaces"] = lambda frame: surface_mesh(tree, indices, frame)
    places = {"points": f"particles/{chosen[0]}", "surfaces": f"surface/{outlined[0]}" if outlined else ""}
    times = times_of(tree).tolist()
    has_series = "series" in tree.children and bool(tree["series"].data_vars)
    for file in [target.collection(kind) for kind in kinds] + [target.series] * has_series:
        check_new(file, force)
    for kind in kinds:
        folder = target.frame(kind, 0).parent
        folder.mkdir(parents=True, exist_ok=True)
        for frame in sorted(folder.glob("[0-9][0-9][0-9][0-9][0-9].vtu")):  # of an export of more outputs
            check_new(frame, force).unlink()
    for done, index in enumerate(frames):
        for kind, mesh_of in kinds.items():
            mesh = mesh_of(index)
            units = unit_of(tree, [*mesh.point_data, *mesh.cell_data], places[kind])
            write_mesh(target.frame(kind, index), mesh, times[index], _about(tree, indices, units))
        if progress is not None:
            progress(done + 1, len(frames))
    # The collections come last: what they list is there
    for kind in kinds:
        files = [target.frame(kind, index) for index in frames]
        write_collection(target.collection(kind), [times[index] for index in frames], files)
    written = [target.collection(kind) for kind in kinds]
    if has_series:
        written.append(target.series)
        series = tree["series"].to_dataset().load()
        write_series(written[-1], series, range(0, series.sizes["time"], every))
    return written


def _about(tree: xr.DataTree, indices: dict[str, int], units: dict[str, str]) -> dict[str, str]:
    """Texts of the field data; ``bodies`` says which index is which body, ``units`` which field has which."""
    own = {name: attribute(tree, name) for name in _ABOUT if attribute(tree, name)}
    names = {str(index): body for body, index in indices.items()}
    return {**own, "bodies": json.dumps(names), "units": json.dumps(units)}


def _tell(names: list[str]) -> None:
    if names:
        warnings.warn(
            f"not exported, being no scalar, vector or tensor of a point: {', '.join(names)}",
            ResultsWarning,
            stacklevel=4,
        )
