"""Checkpoints that are made or changed by hand, with a checksum that is right."""

from __future__ import annotations

import json
import zlib
from pathlib import Path
from typing import Any


def content(header: Any, data: bytes = b"", longer: int = 0, check: int | None = None) -> bytes:
    """Bytes of a file of this header, which says to be ``longer`` than it is, and of bare numbers."""
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    whole = (len(text) + longer).to_bytes(8, "little") + text + data
    return whole + (zlib.crc32(whole) if check is None else check).to_bytes(8, "little")


def header(facts: Any = None, **entries: Any) -> dict[str, Any]:
    """A header that has these facts and these arrays."""
    return {"__metadata__": {"mpmfw": "checkpoint 3", "facts": json.dumps(facts)}, **entries}


def entry(kind: Any, shape: Any, begin: Any, end: Any) -> dict[str, Any]:
    """An array in a header."""
    return {"dtype": kind, "shape": shape, "data_offsets": [begin, end]}


#: What the last entry of every header is, if it has no other.
LAST = {"crc32": entry("I64", [1], 0, 8)}


def opened(path: Path) -> tuple[dict[str, Any], Any, bytes]:
    """The header, the facts, and the bare numbers of a checkpoint."""
    whole = path.read_bytes()
    begin = 8 + int.from_bytes(whole[:8], "little")
    found = json.loads(whole[8:begin])
    return found, json.loads(found["__metadata__"]["facts"]), whole[begin:-8]
