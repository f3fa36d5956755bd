"""One writer for each file: a second one would overwrite the first's frames with its own.

The lock is one of POSIX, of the open file where the system has such (Linux): the HDF5 library, which may take
``flock`` on the same file, does not see it. It ends with the process that holds it, however that ends.
"""

from __future__ import annotations

import contextlib
import errno
import importlib
import os
import struct
from typing import Any

from mpmfw.errors import MpmfwError

fcntl: Any = None
with contextlib.suppress(ImportError):  # a platform without such locks
    fcntl = importlib.import_module("fcntl")

#: Files that this process writes: a lock of a process, where there is no other, does not keep out the process
#: itself.
_OWN: set[str] = set()


def claim(path: str) -> int | None:
    """Take the lock of a file before it is emptied, for :func:`release`; None where there are no locks."""
    if fcntl is None:
        return None
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    if os.path.realpath(path) in _OWN or not _locked(descriptor, fcntl.F_WRLCK):
        os.close(descriptor)
        raise MpmfwError(f"'{path}' is being written by another run; give another name, or wait for its end")
    _OWN.add(os.path.realpath(path))
    return descriptor


def release(path: str | None, descriptor: int | None) -> None:
    """Give the lock of a file back."""
    if path is not None and descriptor is not None:
        _OWN.discard(os.path.realpath(path))
        with contextlib.suppress(OSError):
            os.close(descriptor)


def replace_claimed(part: str, path: str, descriptor: int | None) -> None:
    """Rename ``part``, which is being written, to ``path``, whose claim ends."""
    _OWN.discard(os.path.realpath(part))
    os.replace(part, path)
    release(path, descriptor)
    _OWN.add(os.path.realpath(path))


def is_written(path: str | os.PathLike[str]) -> bool:
    """Return whether a run is writing the file now."""
    if fcntl is None:
        return False
    if os.path.realpath(path) in _OWN:
        return True
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except OSError:
        return False
    try:
        return not _locked(descriptor, fcntl.F_RDLCK)
    finally:
        os.close(descriptor)


def _locked(descriptor: int, kind: int) -> bool:
    """Return whether the lock was taken; a file system without locks refuses nobody."""
    command = getattr(fcntl, "F_OFD_SETLK", fcntl.F_SETLK)
    whole_file = struct.pack("hhqqi4x", kind, os.SEEK_SET, 0, 0, 0)
    try:
        if command == fcntl.F_SETLK:
            write = kind == fcntl.F_WRLCK
            fcntl.lockf(descriptor, (fcntl.LOCK_EX if write else fcntl.LOCK_SH) | fcntl.LOCK_NB)
        else:
            fcntl.fcntl(descriptor, command, whole_file)
    except OSError as error:
        return error.errno not in (errno.EAGAIN, errno.EACCES)
    return True
