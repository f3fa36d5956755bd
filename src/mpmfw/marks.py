"""The mark of figures, pages and tables that mpmfw wrote, by which it knows that it may replace them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mpmfw.errors import MpmfwError, SceneError

#: What figures, films and pages say in a place that readers do not show.
MARK = "written by mpmfw"

#: Metadata of a figure by format: the mark, and nothing that would make two drawings of the same figure differ.
FIGURE: dict[str, dict[str, Any]] = {
    ".png": {"Comment": MARK},
    ".pdf": {"Creator": MARK, "CreationDate": None},
    ".svg": {"Creator": MARK, "Date": None},
}


def is_own(path: Path, head: str = "", mark: str = MARK) -> bool:
    """Whether a file begins with ``head`` and says ``mark`` anywhere.

    Raises
    ------
    OSError
        It cannot be read.
    """
    content = path.read_bytes()
    return content.startswith(head.encode()) and mark.encode() in content


def check_not_lost(path: Path, what: str, head: str = "", mark: str = MARK) -> Path:
    """The path, if there is no file, an empty one, or one that mpmfw wrote; asked before long work.

    Parameters
    ----------
    path
        Of the file to write.
    what
        What is written there.
    head, mark
        By which :func:`is_own` knows such files.

    Raises
    ------
    SceneError
        There is a file of somebody else.
    MpmfwError
        It cannot be read.
    """
    try:
        if path.is_file() and path.stat().st_size and not is_own(path, head, mark):
            raise SceneError(
                f"{path}: is there already and is no {what} that mpmfw wrote, so it is not replaced; give another name"
            )
    except OSError as error:
        raise MpmfwError(f"cannot read '{path}': {error.strerror or error}") from error
    return path
