"""One writer for each file: a second one would overwrite the first's frames.

The lock is Linux's, of an open file description. It ends with its process, and neither the HDF5 library nor
another descriptor of the process releases it. On other systems there is none.
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
with contextlib.suppress(ImportError):  # Windows
    fcntl = importlib.import_module("fcntl")


def claim(path: str) -> int:
    """Take the lock of a file; return a descriptor for :func:`release`."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    if not _locked(descriptor, "F_WRLCK"):
        os.close(descriptor)
        raise MpmfwError(f"'{path}' is being written by another run; give another name, or wait for its end")
    return descriptor


def release(descriptor: int | None) -> None:
    """Give the lock of a file back."""
    if descriptor is not None:
        with contextlib.suppress(OSError):
            os.close(descriptor)


def is_written(path: str | os.PathLike[str]) -> bool:
    """Return whether a run is writing the file now."""
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except OSError:
        return False
    try:
        return not _locked(descriptor, "F_RDLCK")
    finally:
        os.close(descriptor)


def _locked(descriptor: int, kind: str) -> bool:
    """Return True if the lock was taken, or there are none."""
    if not hasattr(fcntl, "F_OFD_SETLK"):
        return True
    whole_file = struct.pack("hhqqi4x", getattr(fcntl, kind), os.SEEK_SET, 0, 0, 0)
    try:
        fcntl.fcntl(descriptor, fcntl.F_OFD_SETLK, whole_file)
    except OSError as error:
        return error.errno not in (errno.EAGAIN, errno.EACCES)
    return True
