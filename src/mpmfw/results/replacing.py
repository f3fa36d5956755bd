"""Write files whole or not at all, by one writer each; results replace only results of their kind."""

from __future__ import annotations

import contextlib
import errno
import importlib
import os
import re
import shutil
import struct
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import netCDF4

from mpmfw.errors import MpmfwError, SceneError

if TYPE_CHECKING:
    import xarray as xr


#: Characters of a file's name in that of its unfinished successor; names have at most 255 bytes.
_REPEATED = 50

#: Bytes that must be free beside a frame: the file's own tables, and the attributes of the end.
_MARGIN = 1_000_000


def check_room(path: str, size: int) -> None:
    """Raise an OSError if a disk has no room for ``size`` bytes more."""
    if shutil.disk_usage(os.path.dirname(path) or ".").free < size + _MARGIN:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def check_writable(path: Path) -> Path:
    """Return the path; raise a SceneError if it cannot be written."""
    if os.path.islink(os.path.realpath(path)):
        raise SceneError(f"{path}: is a link that leads to itself; give the name of a file")
    if path.is_dir():
        raise SceneError(f"{path}: is a folder; give the name of a file")
    if path.exists() and not path.is_file():
        raise SceneError(f"{path}: is a device or a pipe; give the name of a file")
    folder = (Path(os.path.realpath(path)) if path.is_symlink() else path).parent
    if not folder.is_dir():
        raise SceneError(f"{path}: the folder {folder} does not exist")
    if not all(os.access(one, os.W_OK) for one in (folder, path) if one.exists()):
        raise SceneError(f"{path}: cannot be written")
    return path


def check_replaceable(path: str | os.PathLike[str], kind: str) -> None:
    """Raise a SceneError if results of a ``kind`` cannot be written there."""
    try:
        os.fspath(path).encode()
    except UnicodeEncodeError as error:
        raise SceneError(f"{os.fspath(path)!r}: is not UTF-8, as a file's name must be") from error
    path = check_writable(Path(path))
    if path.is_file() and path.stat().st_size and kind_of_file(path) != kind:
        raise SceneError(f"{path}: has no results of kind '{kind}', so it is not replaced")


def check_new(path: Path, force: bool = False) -> Path:
    """Return the path; raise a SceneError if a file would be lost."""
    if not force and path.is_file() and path.stat().st_size:
        raise SceneError(f"{path}: exists already; give another name, or --force to replace it")
    return path


def kind_of_file(path: Path) -> str | None:
    """Return the kind of a results' file, None for any other file."""
    try:
        with netCDF4.Dataset(os.fspath(path)) as dataset:
            return str(getattr(dataset, "kind", ""))
    except (OSError, RuntimeError, UnicodeError):
        return None


def abandoned(path: str | os.PathLike[str]) -> list[Path]:
    """Return the unfinished files of killed processes."""
    target = Path(os.path.realpath(path))
    stem, suffix = re.escape(target.stem[:_REPEATED]), re.escape(target.suffix[:_REPEATED])
    name = re.compile(rf"\.{stem}\.[0-9a-f]{{32}}\.part{suffix}")
    try:
        return [one for one in target.parent.iterdir() if name.fullmatch(one.name) and not one.is_dir()]
    except OSError:
        return []


@contextlib.contextmanager
def replacement(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Context with the name of a temporary file, which replaces ``path`` on success."""
    target = Path(os.path.realpath(path))
    name = f".{target.stem[:_REPEATED]}.{uuid.uuid4().hex}.part{target.suffix[:_REPEATED]}"
    growing = target.with_name(name)
    try:
        yield growing
        with open(growing, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(growing, target)
    except OSError as error:
        raise MpmfwError(f"cannot write '{os.fspath(path)}': {error.strerror or error}") from error
    finally:
        with contextlib.suppress(OSError):
            growing.unlink()


def replace_bytes(content: bytes | memoryview, path: str | os.PathLike[str]) -> None:
    """Write bytes as :func:`replacement` does."""
    with replacement(path) as growing, open(growing, "xb") as file:
        file.write(content)


def replace_dataset(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a dataset as NetCDF, built in memory: HDF5 keeps a file open when its disk is full."""
    from xarray.backends import NetCDF4DataStore

    with replacement(path) as growing:
        check_room(os.fspath(growing), dataset.nbytes)
        try:
            file: Any = netCDF4.Dataset(os.fspath(growing), "w", diskless=True, persist=True)
            dataset.dump_to_store(NetCDF4DataStore(file))  # type: ignore[no-untyped-call]
            file.close()
        except RuntimeError as error:
            raise MpmfwError(f"cannot write '{os.fspath(path)}': {error}") from error


fcntl: Any = None
with contextlib.suppress(ImportError):  # Windows
    fcntl = importlib.import_module("fcntl")


def claim(path: str) -> int:
    """Lock a file; return a descriptor for :func:`release`.

    The lock belongs to Linux's open file description. It ends with the process, and no other descriptor of
    the process, such as the HDF5 library's, releases it. Other systems have no lock.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    if not _locked(descriptor, "F_WRLCK"):
        os.close(descriptor)
        raise MpmfwError(f"'{path}' is being written by another run; give another name, or wait for its end")
    return descriptor


def release(descriptor: int | None) -> None:
    """Release the lock of a file."""
    if descriptor is not None:
        with contextlib.suppress(OSError):
            os.close(descriptor)


def is_written(path: str | os.PathLike[str]) -> bool:
    """Return True if a run is writing the file."""
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except OSError:
        return False
    try:
        return not _locked(descriptor, "F_RDLCK")
    finally:
        os.close(descriptor)


def _locked(descriptor: int, kind: str) -> bool:
    """Return True if the lock was taken, or the system has none."""
    if not hasattr(fcntl, "F_OFD_SETLK"):
        return True
    whole_file = struct.pack("hhqqi4x", getattr(fcntl, kind), os.SEEK_SET, 0, 0, 0)
    try:
        fcntl.fcntl(descriptor, fcntl.F_OFD_SETLK, whole_file)
    except OSError as error:
        return error.errno not in (errno.EAGAIN, errno.EACCES)
    return True
