"""Which files of a folder a store of finished runs wrote: known by what they are called and by what they hold, both."""

from __future__ import annotations

import json
import re
from pathlib import Path

from mpmfw.results.replacing import kind_of_file

#: What is written with every outcome, in every version.
_FIELDS = frozenset({"key", "status", "name", "digest", "costs"})
_WHOLE = re.compile(r"([0-9a-f]{32})\.(json|nc)")
_HALF = re.compile(r"\.[0-9a-f]{32}\.[0-9a-f]{32}\.part\.(json|nc)")

#: How the files begin, by ending.
_HEADS = {"nc": b"\x89HDF\r\n\x1a\n", "json": b"{\n"}


def key_in(path: Path, ending: str) -> str:
    """The key of the run that a file of this ending is called by; empty of other names."""
    found = _WHOLE.fullmatch(path.name)
    return found.group(1) if found and found.group(2) == ending else ""


def own_files(folder: Path) -> list[Path]:
    """The files of a folder that a store wrote, whole or by half; no link is one, and none is followed.

    Raises
    ------
    OSError
        The folder cannot be read.
    """
    return [path for path in sorted(folder.iterdir()) if _is_own(path)]


def _is_own(path: Path) -> bool:
    if path.is_symlink() or not path.is_file():
        return False
    if half := _HALF.fullmatch(path.name):
        head = _HEADS[half.group(1)]
        with path.open("rb") as file:
            return head.startswith(file.read(len(head)))
    if key_in(path, "nc"):
        return kind_of_file(path) == "run"
    return key_in(path, "json") != "" and _holds_outcome(path)


def _holds_outcome(path: Path) -> bool:
    try:
        fields = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(fields, dict) and fields.keys() >= _FIELDS and fields["key"] == path.stem
