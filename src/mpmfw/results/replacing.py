"""Write a file that holds one dataset: never in place of another kind of file, and never by halves."""

from __future__ import annotations

import contextlib
import os
import uuid
from pathlib import Path
from typing import TYPE_CHECKING

import netCDF4

from mpmfw.errors import MpmfwError, SceneError

if TYPE_CHECKING:
    import xarray as xr


def check_replaceable(path: str | os.PathLike[str], kind: str, what: str) -> None:
    """Ask, before long work, that a file can be written and takes the place of none, of an empty one, or of one of its own kind.

    Parameters
    ----------
    path
        Of the file.
    kind, what
        The attribute ``kind`` of such files, and what they are called.

    Raises
    ------
    SceneError
        There is another file.
    MpmfwError
        None can be written there.
    """
    path = Path(path)
    if not path.parent.is_dir():
        raise MpmfwError(f"cannot create '{path}': there is no folder '{path.parent}'")
    if not os.access(path.parent, os.W_OK) or path.is_dir():
        raise MpmfwError(f"cannot create '{path}': not writable")
    if path.is_file() and path.stat().st_size and kind_of_file(path) != kind:
        raise SceneError(
            f"{path}: is there already and is no {what}, so it is not replaced; give another name"
        )


def kind_of_file(path: Path) -> str | None:
    """What a results' file says that it is; None of any other file."""
    try:
        with netCDF4.Dataset(os.fspath(path)) as dataset:
            return str(getattr(dataset, "kind", ""))
    except OSError:
        return None


def replace_dataset(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a dataset as NetCDF in one step: readers see the old file or the new one, whole.

    Raises
    ------
    MpmfwError
        It cannot be written.
    """
    growing = _growing(Path(path))
    try:
        dataset.to_netcdf(growing, engine="netcdf4")
        os.replace(growing, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            growing.unlink()
        raise MpmfwError(f"cannot write '{os.fspath(path)}': {error.strerror or error}") from error


def _growing(path: Path) -> Path:
    """What a file is called until it is whole: as no other is."""
    return path.with_name(f".{path.name}.{uuid.uuid4().hex}.part")


def replace_bytes(content: bytes, path: Path) -> None:
    """Write bytes in one step, with the rights that the umask leaves; the folder is made if it is not there.

    Raises
    ------
    MpmfwError
        They cannot be written.
    """
    growing = _growing(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with open(growing, "xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(growing, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            growing.unlink()
        raise MpmfwError(f"cannot write '{path}': {error.strerror or error}") from error
