"""Whether a frame finds room on its disk: asked before it is written.

A NetCDF file whose writing fails half-way cannot be opened again, and all frames before are lost. Room is
therefore taken in a file without a name beside it, and given back: what would refuse the frame, a full disk,
a quota or a limit of file sizes, refuses that, and the results' file stays whole.
"""

from __future__ import annotations

import errno
import os
import tempfile

from mpmfw.errors import MpmfwError

#: Bytes that must be free beside a frame: the file's own tables, and the attributes that are written at the
#: end.
MARGIN = 1_000_000

#: What says that there is no room; a file system that cannot take room in advance says something else.
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def check_room(path: str, size: int, what: str, *, anew: bool = False) -> None:
    """Ask that ``size`` bytes and a margin fit behind the end of a file.

    Parameters
    ----------
    path
        Of the file.
    what
        What is to be written, for the message.
    anew
        The file is about to be emptied.

    Raises
    ------
    MpmfwError
        They do not: the disk is full, or a quota or a limit of the file's size is reached.
    """
    end = 0 if anew else os.path.getsize(path)
    if refused := _refusal(path, end, size + MARGIN):
        kept = "" if anew else "; what was written before is readable"
        raise MpmfwError(f"cannot write {what} to '{path}': {refused.strerror}{kept}") from refused


def _refusal(path: str, end: int, size: int) -> OSError | None:
    """Why a file that ends at ``end`` cannot grow by ``size`` bytes; None if it can, or nobody knows."""
    if not hasattr(os, "posix_fallocate"):
        return None
    try:
        with tempfile.TemporaryFile(dir=os.path.dirname(path) or ".") as probe:
            os.posix_fallocate(probe.fileno(), end, size)
    except OSError as error:
        return error if error.errno in _NO_ROOM else None
    return None
