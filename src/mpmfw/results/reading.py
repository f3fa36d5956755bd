"""Open a results' file."""

from __future__ import annotations

import builtins
import os
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import netCDF4
import numpy as np

from mpmfw.errors import MpmfwError, ResultsWarning, SceneError
from mpmfw.results.writers import is_written

if TYPE_CHECKING:
    import xarray as xr  # half a second, which a run that nobody reads does without

#: What is said of an HDF5 file that the library cannot read.
_DAMAGED = "the file was cut short or is damaged"

#: Files that are open until their tree is closed: left to the garbage collector, a file may be freed before its groups, and
#: the HDF5 library then fails in whatever is opened next.
_OPEN: set[netCDF4.Dataset] = set()


def open(path: str | os.PathLike[str], *, lazy: bool = False) -> xr.DataTree:
    """Open the file of a run, a comparison or a study.

    Parameters
    ----------
    path
        File written by ``run``, ``compare`` or ``study``; a run's file may still be growing.
    lazy
        Leave the arrays on disk and the file open until ``.close()`` of the tree; the default reads all and
        closes the file.

    Returns
    -------
    xarray.DataTree
        Of a run: groups ``series``, ``particles/<body>``, ``surface/<body>``, ``contact/<pair>``, each with its ``time``,
        which is at the root where all have the same. Of a comparison or a study: the root alone, whose ``.dataset`` holds
        the variables.

    Raises
    ------
    MpmfwError
        The file does not exist, is no results' file, or was cut short.

    Warns
    -----
    ResultsWarning
        The run that wrote it is not finished: it goes on, was killed or interrupted, or failed.
    """
    tree = read(path, lazy=lazy)
    if text := unfinished(tree, path):
        warnings.warn(text, ResultsWarning, stacklevel=2)
    return tree


def unfinished(tree: xr.DataTree, path: str | os.PathLike[str]) -> str:
    """What keeps the results of a run from being complete, in a sentence; empty if nothing does."""
    status = str(tree.attrs.get("status", "ok"))
    if tree.attrs.get("kind") != "run" or status == "ok":
        return ""
    if status == "running":
        status = (
            "is still being written"
            if is_written(path)
            else "was broken off: its run did not come to its end"
        )
    else:
        status = f"is not complete: {status}"
    time = output_times(tree)
    count = 0 if time is None else time.size
    last = "" if time is None or not count else f", the last at {float(time[-1]):.6g} s"
    goes_on = tree.attrs["status"] == "running" and is_written(path)
    how = "" if goes_on else _how_to_go_on(os.fspath(path))
    return f"{os.fspath(path)} {status}; it holds {count} outputs{last}{how}"


def output_times(tree: xr.DataTree) -> xr.DataArray | None:
    """Times of a run's outputs [s]; None of what has none."""
    times: xr.DataArray | None = (tree["series"] if "series" in tree.children else tree).coords.get("time")
    return times


def read(path: str | os.PathLike[str], *, lazy: bool = False) -> xr.DataTree:
    """The same as :func:`open`, without a word on results that are not complete.

    Raises
    ------
    MpmfwError
        The file does not exist, is no results' file, or was cut short.
    """
    name = os.fspath(path)
    try:
        dataset = netCDF4.Dataset(name)
    except OSError as error:
        raise MpmfwError(f"cannot read '{name}': {_reason(name, error)}{_how_to_go_on(name)}") from error
    if lazy:
        tree = tree_of(dataset, load=False)
        _OPEN.add(dataset)
        tree.set_close(lambda: _close(dataset))
        return tree
    try:
        return tree_of(dataset)
    except RuntimeError as error:
        raise MpmfwError(f"cannot read '{name}': {_DAMAGED}{_how_to_go_on(name)}") from error
    finally:
        dataset.close()


def _reason(name: str, error: OSError) -> str:
    """Why a file cannot be read: of an HDF5 file that is not whole, the library says nothing of use."""
    return _DAMAGED if is_hdf5(name) else str(error.strerror or error)


def is_hdf5(path: str) -> bool:
    """Whether a file begins as one of HDF5, whole or not."""
    try:
        with builtins.open(path, "rb") as file:
            return file.read(8) == b"\x89HDF\r\n\x1a\n"
    except OSError:
        return False


def _how_to_go_on(name: str) -> str:
    """What to do with the file of a run that did not end, if it has a checkpoint."""
    return f"; mpmfw resume {name} goes on with it" if os.path.isfile(f"{name}.checkpoint") else ""


def check_results(path: str | os.PathLike[str]) -> None:
    """Ask that a file is a results' file.

    Raises
    ------
    SceneError
        It is none.
    """
    try:
        netCDF4.Dataset(os.fspath(path)).close()
    except OSError as error:
        raise SceneError(
            f"{os.fspath(path)}: is no results' file ({_reason(os.fspath(path), error)})"
        ) from error


def tree_of(dataset: netCDF4.Dataset, *, load: bool = True) -> xr.DataTree:
    """Return the groups of an open file as a tree, without a last frame that was cut short.

    The time of an output is written after its arrays: one without a time is incomplete.
    """
    import xarray as xr

    groups = {name: xr.open_dataset(_store(group), decode_times=False) for name, group in _groups(dataset)}
    groups = _with_times(_complete(groups))
    if load:
        groups = {name: group.load() for name, group in groups.items()}
    for name in [name for name, group in groups.items() if _count_of(group) is not None]:
        groups |= by_body(name, groups.pop(name), groups["/"]["body"].values.tolist())
    return xr.DataTree.from_dict(groups)


def _complete(groups: dict[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """The groups without what was written of an output before its time was."""
    time = groups["/"].coords.get("time")
    if time is None:
        return groups
    count = int(np.isfinite(time.values).sum())
    end = float(time.values[count - 1]) if count else -np.inf
    return {
        name: group.isel(
            time=slice(int((group["time"].values <= end).sum()) if "time" in group.coords else count)
        )
        if "time" in group.sizes
        else group
        for name, group in groups.items()
    }


def _with_times(groups: dict[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """The groups with their time at the root if all have the same, and else at each."""
    times = groups["/"].coords.get("time")
    own = groups["/particles"].coords.get("time") if "/particles" in groups else None
    if times is None or own is None:
        return groups
    if not own.size or np.array_equal(own.values, times.values):
        return groups | {"/particles": groups["/particles"].drop_vars("time")}
    at_each = {
        name: group.assign_coords(time=times) if "time" in group.sizes and name != "/particles" else group
        for name, group in groups.items()
    }
    return at_each | {"/": groups["/"].drop_vars("time")}


def by_body(place: str, ragged: xr.Dataset, bodies: list[str]) -> dict[str, xr.Dataset]:
    """A group of its own for every body that has points in a ragged one, by path; bodies that have none are left out.

    Parameters
    ----------
    place
        Path of the ragged group, whose count of each body's points names their dimension.
    """
    count = _count_of(ragged)
    if count is None:
        return {place: ragged}
    dim, points = (
        str(count.attrs["sample_dimension"]),
        ragged.drop_vars([str(count.name), "body"], errors="ignore"),
    )
    stops = np.cumsum(count.values)
    return {
        f"{place}/{body}": points.isel({dim: slice(stop - size, stop)}, missing_dims="ignore")
        for body, size, stop in zip(bodies, count.values.tolist(), stops.tolist(), strict=True)
        if size
    }


def _count_of(group: xr.Dataset) -> xr.DataArray | None:
    """How many points of each body a ragged group has; None of any other group."""
    return next((array for array in group.data_vars.values() if "sample_dimension" in array.attrs), None)


def _groups(group: netCDF4.Dataset) -> Iterator[tuple[str, netCDF4.Dataset]]:
    yield group.path, group
    for child in group.groups.values():
        yield from _groups(child)


def _store(group: netCDF4.Dataset) -> Any:
    from xarray.backends import NetCDF4DataStore

    return NetCDF4DataStore(group)  # type: ignore[no-untyped-call]


def _close(dataset: netCDF4.Dataset) -> None:
    _OPEN.discard(dataset)
    if dataset.isopen():
        dataset.close()
