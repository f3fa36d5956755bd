"""One writer for each file: a second one would overwrite the first's frames with its own."""

from __future__ import annotations

import contextlib
import errno
import importlib
import os
from typing import Any

from mpmfw.errors import MpmfwError

fcntl: Any = None
with contextlib.suppress(ImportError):  # a platform without such locks
    fcntl = importlib.import_module("fcntl")


def claim(path: str) -> int | None:
    """Take the lock of a file that is to be written, before it is emptied.

    The lock ends with the process that holds it, however that ends.

    Returns
    -------
    What :func:`release` takes; None where there are no locks.

    Raises
    ------
    MpmfwError
        Another writer has it.
    OSError
        The file cannot be created.
    """
    if fcntl is None:
        return None
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(descriptor)
        if error.errno in (errno.EWOULDBLOCK, errno.EACCES):
            raise MpmfwError(
                f"'{path}' is being written by another run; give another name, or wait for its end"
            ) from error
        return None  # a file system without locks
    return descriptor


def release(descriptor: int | None) -> None:
    """Give the lock back."""
    if descriptor is not None:
        with contextlib.suppress(OSError):
            os.close(descriptor)


def is_written(path: Any) -> bool:
    """Whether a run is writing the file now."""
    if fcntl is None:
        return False
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except OSError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno in (errno.EWOULDBLOCK, errno.EACCES)
    finally:
        os.close(descriptor)
    return False
