"""Open a results' file."""

from __future__ import annotations

import builtins
import os
import warnings
from collections.abc import Iterator
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from xarray.backends import NetCDF4DataStore

from mpmfw.errors import MpmfwError, ResultsWarning, SceneError
from mpmfw.results.writers import is_written

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
        Of a run: groups ``series``, ``particles/<body>``, ``surface/<body>``, ``contact/<pair>``. Of a
        comparison or a study: the root alone, whose ``.dataset`` holds the variables.

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
    if said := unfinished(tree, path):
        warnings.warn(said, ResultsWarning, stacklevel=2)
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
    time = tree.coords.get("time")
    count = 0 if time is None else time.size
    last = "" if time is None or not count else f", the last at {float(time[-1]):.6g} s"
    return f"{os.fspath(path)} {status}; it holds {count} outputs{last}"


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
        raise MpmfwError(f"cannot read '{name}': {_reason(name, error)}") from error
    if lazy:
        tree = tree_of(dataset, load=False)
        _OPEN.add(dataset)
        tree.set_close(lambda: _close(dataset))
        return tree
    try:
        return tree_of(dataset)
    finally:
        dataset.close()


def _reason(name: str, error: OSError) -> str:
    """Why a file cannot be read: of an HDF5 file that is not whole, the library says nothing of use."""
    try:
        with builtins.open(name, "rb") as file:
            begins_well = file.read(8) == b"\x89HDF\r\n\x1a\n"
    except OSError:
        begins_well = False
    return "the file was cut short or is damaged" if begins_well else str(error.strerror or error)


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

    The time of a frame is written after its arrays: a frame without a time is incomplete.
    """
    groups = {name: xr.open_dataset(_store(group), decode_times=False) for name, group in _groups(dataset)}
    time = groups["/"].coords.get("time")
    if time is not None:
        complete = np.flatnonzero(np.isfinite(time.values))
        # A group with a time of its own may have one frame more than the root.
        groups = {
            name: group.isel(time=complete)
            if group.sizes.get("time", len(complete)) > len(complete)
            else group
            for name, group in groups.items()
        }
    if load:
        groups = {name: group.load() for name, group in groups.items()}
    return xr.DataTree.from_dict(groups)


def _groups(group: netCDF4.Dataset) -> Iterator[tuple[str, netCDF4.Dataset]]:
    yield group.path, group
    for child in group.groups.values():
        yield from _groups(child)


def _store(group: netCDF4.Dataset) -> Any:
    return NetCDF4DataStore(group)  # type: ignore[no-untyped-call]


def _close(dataset: netCDF4.Dataset) -> None:
    _OPEN.discard(dataset)
    if dataset.isopen():
        dataset.close()
