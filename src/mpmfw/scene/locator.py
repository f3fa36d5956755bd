"""Lines of a TOML document's keys, which the parser of the standard library does not tell."""

from __future__ import annotations

import bisect
import functools
import itertools
import operator
import re
import tomllib
from contextlib import suppress
from typing import Any

Path = tuple[str | int, ...]

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")

#: Ends of texts, arrays and inline tables, one of which completes the first lines of a document.
_ENDS = [
    text + "".join(ends)
    for count in range(4)
    for ends in itertools.product("]}", repeat=count)
    for text in ("\n", '"""', "'''")
]


class Locator:
    """Lines of the keys of a valid TOML document, each the last line that is needed to read the key."""

    def __init__(self, text: str) -> None:
        self._lines = text.replace("\r\n", "\n").split("\n")
        self._read = functools.cache(self._read_first)

    def __contains__(self, path: Path) -> bool:
        return _holds(self._read(len(self._lines)), path)

    def line(self, path: Path) -> int:
        """Line (from 1) of the key, or of the nearest table or array around it; 1 for the root."""
        while path not in self:
            path = path[:-1]
        counts = range(1, len(self._lines) + 1)
        return 1 + bisect.bisect_left(counts, True, key=lambda count: _holds(self._read(count), path))

    def _read_first(self, count: int) -> dict[str, Any]:
        """Parse the first lines, or as many of them as make a document."""
        for least, end in itertools.product(range(count, 0, -1), _ENDS):
            with suppress(tomllib.TOMLDecodeError):
                return tomllib.loads("\n".join(self._lines[:least]) + end)
        return {}


def _holds(table: Any, path: Path) -> bool:
    with suppress(LookupError, TypeError):
        functools.reduce(operator.getitem, path, table)
        return True
    return False


def dotted(path: Path) -> str:
    """The path as a user writes it: ``contact.pairs[0].friction``."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            quoted = part.replace("\\", "\\\\").replace('"', '\\"')
            name = part if _BARE_KEY.fullmatch(part) else f'"{quoted}"'
            text += f".{name}" if text else name
    return text
