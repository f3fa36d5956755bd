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
from mpmfw.results.replacing import is_written

if TYPE_CHECKING:
    import xarray as xr  # half a second, which a run that nobody reads does without

#: Message on an HDF5 file that the library cannot read.
DAMAGED = "the file was cut short or is damaged"

#: Largest size in memory over the length of a file, and bytes beside.
LARGER, SPARE = 100, 100_000_000

#: Files that are open until their tree is closed: HDF5 fails if a file is freed before its groups.
_OPEN: set[netCDF4.Dataset] = set()


def open(path: str | os.PathLike[str], *, lazy: bool = False) -> xr.DataTree | xr.Dataset:
    """Open a results file as the object that ``run``, ``compare`` or ``study`` returned.

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
        For a run a tree with the groups ``series``, ``particles/<body>``, ``surface/<body>`` and
        ``contact/<pair>``, each with its ``time``; otherwise a dataset. Incomplete outputs are left out.

    Raises
    ------
    MpmfwError
        The file does not exist, does not hold results, or was cut short.

    Warns
    -----
    ResultsWarning
        The run that wrote it has not finished: it still runs, was killed or interrupted, or failed.
    """
    import xarray as xr

    results = read(path, lazy=lazy)
    status = str(results.attrs.get("status", "ok"))
    if isinstance(results, xr.DataTree) and results.attrs.get("kind") == "run" and not is_complete(status):
        warnings.warn(_unfinished(results, os.fspath(path), status), ResultsWarning, stacklevel=2)
    return results


def _unfinished(tree: xr.DataTree, name: str, status: str) -> str:
    how = _how_to_go_on(name)
    if status != "running":
        text = f"is not complete: {status}"
    elif is_written(name):
        text, how = "is still being written", ""
    else:
        text = "was broken off: its run did not come to its end"
    time = output_times(tree).values
    last = f", the last at {float(time[-1]):.6g} s" if time.size else ""
    return f"{name} {text}; it holds {time.size} outputs{last}{how}"


def output_times(tree: xr.DataTree) -> xr.DataArray:
    """Return the times of a run's outputs [s]."""
    return (tree["series"] if "series" in tree.children else tree).to_dataset()["time"]


def read(path: str | os.PathLike[str], *, lazy: bool = False) -> xr.DataTree | xr.Dataset:
    """Return the same as :func:`open`, without a warning."""
    name = os.fspath(path)
    try:
        dataset = netCDF4.Dataset(name)
    except (OSError, UnicodeError) as error:
        raise MpmfwError(f"cannot read '{name}': {_reason(name, error)}{_how_to_go_on(name)}") from error
    try:
        tree = checked_tree(dataset, os.path.getsize(name), load=not lazy)
    except MpmfwError as error:
        dataset.close()
        raise MpmfwError(f"cannot read '{name}': {error}{_how_to_go_on(name)}") from error
    results = tree if tree.children or tree.attrs.get("kind") == "run" else tree.to_dataset()
    results.encoding["source"] = name  # as xarray does
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
    """Return the tree of a run's file."""
    import xarray as xr

    tree = read(path)
    if not isinstance(tree, xr.DataTree):
        raise MpmfwError(f"cannot read '{os.fspath(path)}': it does not hold a run")
    return tree


def _reason(name: str, error: OSError | UnicodeError) -> str:
    return DAMAGED if is_hdf5(name) else str(getattr(error, "strerror", None) or error)


def is_hdf5(path: str) -> bool:
    """Return True if a file begins with the signature of HDF5; it may still be damaged."""
    try:
        with builtins.open(path, "rb") as file:
            return file.read(8) == b"\x89HDF\r\n\x1a\n"
    except OSError:
        return False


def _how_to_go_on(name: str) -> str:
    return f"; mpmfw resume {name} continues it" if os.path.isfile(f"{name}.checkpoint") else ""


def check_results(path: str | os.PathLike[str]) -> None:
    """Check that a file is a results' file."""
    try:
        netCDF4.Dataset(os.fspath(path)).close()
    except OSError as error:
        name = os.fspath(path)
        raise SceneError(f"{name}: does not hold results ({_reason(name, error)})") from error


def checked_tree(dataset: netCDF4.Dataset, size: int, *, load: bool) -> xr.DataTree:
    """Return the tree of a file; raise if it declares much more data than its ``size`` [bytes]."""
    declared = sum(8 * v.size for _, group in groups_of(dataset) for v in group.variables.values())
    if declared > LARGER * size + SPARE:
        raise MpmfwError(DAMAGED)
    return tree_of(dataset, load=load)


def tree_of(dataset: netCDF4.Dataset, *, load: bool = True) -> xr.DataTree:
    """Return the complete outputs of an open file as a tree."""
    import xarray as xr
    from xarray.backends import NetCDF4DataStore

    store: Any = NetCDF4DataStore
    try:
        groups = {name: xr.open_dataset(store(group)) for name, group in groups_of(dataset)}
        bodies = groups["/"]["body"].values.tolist() if "body" in groups["/"] else []
        if not all(re.fullmatch("[A-Za-z0-9_]+", str(body)) for body in bodies):
            raise ValueError("no scene can have a body of this name")
        groups = _complete(groups)
        if load:
            groups = {name: group.load() for name, group in groups.items()}
        return xr.DataTree.from_dict(groups)
    except (RuntimeError, OSError, ValueError, TypeError, LookupError, AttributeError, MemoryError) as error:
        raise MpmfwError(DAMAGED) from error


def _complete(groups: dict[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """Return the groups up to the last time at the root."""
    root = groups["/"]
    if "output" not in root.dims:
        return groups
    count = int(np.isfinite(root["time"].values).sum())
    end = float(root["time"].values[count - 1]) if count else -np.inf
    for name, group in groups.items():
        if "time" in group.sizes:
            groups[name] = group.isel(time=slice(int((group["time"].values <= end).sum())))
    return {**groups, "/": root.isel(output=slice(count))}


def groups_of(group: netCDF4.Dataset) -> Iterator[tuple[str, netCDF4.Dataset]]:
    """Yield a group and all below it, with their paths."""
    yield group.path, group
    for child in group.groups.values():
        yield from groups_of(child)
