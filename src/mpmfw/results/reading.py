"""Open a results' file."""

from __future__ import annotations

import builtins
import os
import re
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import netCDF4
import numpy as np

from mpmfw.errors import MpmfwError, ResultsWarning, SceneError, is_complete
from mpmfw.results.writers import is_written

if TYPE_CHECKING:
    import xarray as xr  # half a second, which a run that nobody reads does without

#: Message on an HDF5 file that the library cannot read.
_DAMAGED = "the file was cut short or is damaged"

#: Largest size in memory over the length of a file, and bytes beside: numbers that were never written
#: are NaN.
LARGER, SPARE = 100, 100_000_000

#: Files that are open until their tree is closed: left to the garbage collector, a file may be freed before
#: its groups, and the HDF5 library then fails in whatever is opened next.
_OPEN: set[netCDF4.Dataset] = set()


def open(path: str | os.PathLike[str], *, lazy: bool = False) -> xr.DataTree | xr.Dataset:
    """Open a results' file: what the function returned that made it.

    Parameters
    ----------
    path
        File written by ``run``, ``compare`` or ``study``; a run's file may still be growing.
    lazy
        Leave the arrays on disk and the file open until ``.close()`` of the tree; the default reads all and
        closes the file.

    Returns
    -------
    xarray.DataTree or xarray.Dataset
        Of a run a tree with the groups ``series``, ``particles/<body>``, ``surface/<body>`` and
        ``contact/<pair>``, each with its ``time``; of a comparison, a study, a campaign or a map a dataset.
        They are those of ``xarray.open_datatree`` and ``xarray.open_dataset``, without an output that is not
        complete.

    Raises
    ------
    MpmfwError
        The file does not exist, is no results' file, or was cut short.

    Warns
    -----
    ResultsWarning
        The run that wrote it is not finished: it goes on, was killed or interrupted, or failed.
    """
    import xarray as xr

    results = read(path, lazy=lazy)
    if isinstance(results, xr.DataTree) and (text := unfinished(results, path)):
        warnings.warn(text, ResultsWarning, stacklevel=2)
    return results


def unfinished(tree: xr.DataTree, path: str | os.PathLike[str]) -> str:
    """Return a sentence on results that are not complete; empty if they are."""
    status = str(tree.attrs.get("status", "ok"))
    if tree.attrs.get("kind") != "run" or is_complete(status):
        return ""
    if status == "running":
        status = (
            "is still being written"
            if is_written(path)
            else "was broken off: its run did not come to its end"
        )
    else:
        status = f"is not complete: {status}"
    time = output_times(tree).values
    last = f", the last at {float(time[-1]):.6g} s" if time.size else ""
    goes_on = tree.attrs["status"] == "running" and is_written(path)
    how = "" if goes_on else _how_to_go_on(os.fspath(path))
    return f"{os.fspath(path)} {status}; it holds {time.size} outputs{last}{how}"


def output_times(tree: xr.DataTree) -> xr.DataArray:
    """Return the times of a run's outputs [s]."""
    return (tree["series"] if "series" in tree.children else tree).to_dataset()["time"]


def read(path: str | os.PathLike[str], *, lazy: bool = False) -> xr.DataTree | xr.Dataset:
    """Return the same as :func:`open`, without a warning of results that are not complete."""
    name = os.fspath(path)
    try:
        dataset = netCDF4.Dataset(name)
    except (OSError, UnicodeError) as error:
        raise MpmfwError(f"cannot read '{name}': {_reason(name, error)}{_how_to_go_on(name)}") from error
    try:
        declared = sum(8 * v.size for _, group in _groups(dataset) for v in group.variables.values())
        if declared > LARGER * os.path.getsize(name) + SPARE:
            raise MpmfwError(_DAMAGED)
        tree = tree_of(dataset, load=not lazy)
    except MpmfwError as error:
        dataset.close()
        raise MpmfwError(f"cannot read '{name}': {error}{_how_to_go_on(name)}") from error
    results = tree if tree.children or tree.attrs.get("kind") == "run" else tree.to_dataset()
    if lazy:
        _OPEN.add(dataset)

        def close() -> None:
            _OPEN.discard(dataset)
            if dataset.isopen():
                dataset.close()

        results.set_close(close)
    else:
        dataset.close()
    return results


def read_run(path: str | os.PathLike[str]) -> xr.DataTree:
    """Return the tree of a run's file, as :func:`read` does."""
    import xarray as xr

    tree = read(path)
    if not isinstance(tree, xr.DataTree):
        raise MpmfwError(f"cannot read '{os.fspath(path)}': it is no run's file")
    return tree


def _reason(name: str, error: OSError | UnicodeError) -> str:
    """Return why a file cannot be read; the library's own reason is of no use for damaged HDF5 files."""
    return _DAMAGED if is_hdf5(name) else str(getattr(error, "strerror", None) or error)


def is_hdf5(path: str) -> bool:
    """Return whether a file begins as one of HDF5, whole or not."""
    try:
        with builtins.open(path, "rb") as file:
            return file.read(8) == b"\x89HDF\r\n\x1a\n"
    except OSError:
        return False


def _how_to_go_on(name: str) -> str:
    """Return the advice to resume a run that did not end, if it has a checkpoint."""
    return f"; mpmfw resume {name} goes on with it" if os.path.isfile(f"{name}.checkpoint") else ""


def check_results(path: str | os.PathLike[str]) -> None:
    """Check that a file is a results' file."""
    try:
        netCDF4.Dataset(os.fspath(path)).close()
    except OSError as error:
        raise SceneError(
            f"{os.fspath(path)}: is no results' file ({_reason(os.fspath(path), error)})"
        ) from error


def tree_of(dataset: netCDF4.Dataset, *, load: bool = True) -> xr.DataTree:
    """Return the groups of an open file as a tree, without outputs that are not complete."""
    import xarray as xr
    from xarray.backends import NetCDF4DataStore

    store: Any = NetCDF4DataStore
    try:
        groups = {name: xr.open_dataset(store(group)) for name, group in _groups(dataset)}
        bodies = groups["/"]["body"].values.tolist() if "body" in groups["/"] else []
        if not all(re.fullmatch("[A-Za-z0-9_]+", str(body)) for body in bodies):
            raise ValueError("no scene can have a body of this name")
        groups = _complete(groups)
        if load:
            groups = {name: group.load() for name, group in groups.items()}
        return xr.DataTree.from_dict(groups)
    except (RuntimeError, OSError, ValueError, TypeError, LookupError, AttributeError, MemoryError) as error:
        raise MpmfwError(_DAMAGED) from error


def _complete(groups: dict[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """Return the groups without outputs whose time is not at the root, which is written last."""
    root = groups["/"]
    if "output" not in root.dims:
        return groups
    count = int(np.isfinite(root["time"].values).sum())
    end = float(root["time"].values[count - 1]) if count else -np.inf
    groups = {
        name: group.isel(time=slice(int((group["time"].values <= end).sum())))
        if "time" in group.sizes
        else group
        for name, group in groups.items()
    }
    return {**groups, "/": root.isel(output=slice(count))}


def _groups(group: netCDF4.Dataset) -> Iterator[tuple[str, netCDF4.Dataset]]:
    yield group.path, group
    for child in group.groups.values():
        yield from _groups(child)
