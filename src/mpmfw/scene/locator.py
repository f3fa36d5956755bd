"""Lines of a TOML document's keys, which the parser of the standard library does not tell.

The document was parsed before, so this scanner follows keys, strings and brackets alone, once through.
"""

from __future__ import annotations

import bisect
import functools
import re
import tomllib
from contextlib import suppress

Path = tuple[str | int, ...]

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_SPACE = re.compile(r"[ \t]*")
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_STRING = re.compile(
    r'"""(?:\\.|[^\\])*?"""(?:"{0,2}(?!"))|\'\'\'.*?\'\'\'(?:\'{0,2}(?!\'))|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'',
    re.S,
)
_SCALAR = re.compile(r"[^,\]}\n#]*")


class Locator:
    """Lines of the keys of one valid TOML document."""

    def __init__(self, text: str) -> None:
        self._text = text.replace("\r\n", "\n")
        self._ends = [end.start() for end in re.finditer("\n", self._text)]
        self._at = 0
        self._lines: dict[Path, int] = {}
        self._array_lengths: dict[Path, int] = {}

    @functools.cached_property
    def lines(self) -> dict[Path, int]:
        """Line (from 1) of every key, table header and array element by its path."""
        with suppress(RecursionError):  # deeper than any scene: lines up to there
            self._document()
        return self._lines

    def line(self, path: Path) -> int:
        """Line of the key, or of the nearest table or array around it; 1 for the root."""
        while path and path not in self.lines:
            path = path[:-1]
        return self.lines.get(path, 1)

    def _line_here(self) -> int:
        return bisect.bisect_left(self._ends, self._at) + 1

    def _skip(self, pattern: re.Pattern[str]) -> str:
        match = pattern.match(self._text, self._at)
        assert match is not None, f"TOML that tomllib accepts, not understood at line {self._line_here()}"
        self._at = match.end()
        return match.group()

    def _take(self, token: str) -> bool:
        taken = self._text.startswith(token, self._at)
        self._at += len(token) * taken
        return taken

    def _document(self) -> None:
        table: Path = ()
        self._skip(_BLANK)
        while self._at < len(self._text):
            if self._text[self._at] == "[":
                table = self._header()
            else:
                self._key_and_value(table)
            self._skip(_BLANK)

    def _header(self) -> Path:
        """A ``[table]`` or ``[[array of tables]]``; its path, with indices of arrays' last elements."""
        line = self._line_here()
        is_array = self._take("[[") or not self._take("[")
        path: Path = ()
        names = self._dotted_key()
        for depth, name in enumerate(names):
            path += (name,)
            self._lines.setdefault(path, line)
            if is_array and depth == len(names) - 1:
                self._array_lengths[path] = self._array_lengths.get(path, 0) + 1
            if path in self._array_lengths:
                path += (self._array_lengths[path] - 1,)
                self._lines.setdefault(path, line)
        if not is_array:
            self._lines[path] = line  # a sub-table may stand before its parent's own header
        self._at += 2 if is_array else 1
        return path

    def _dotted_key(self) -> list[str]:
        names = []
        while True:
            self._skip(_SPACE)
            quoted = self._text[self._at] in "\"'"
            names.append(_unquoted(self._skip(_STRING)) if quoted else self._skip(_BARE_KEY))
            self._skip(_SPACE)
            if not self._take("."):
                return names

    def _key_and_value(self, table: Path) -> None:
        line = self._line_here()
        path = table
        for name in self._dotted_key():
            path += (name,)
            self._lines.setdefault(path, line)
        self._at += 1  # the equals sign
        self._skip(_SPACE)
        self._value(path)

    def _value(self, path: Path) -> None:
        if self._take("["):
            self._array(path)
        elif self._take("{"):
            self._inline_table(path)
        elif self._text[self._at] in "\"'":
            self._skip(_STRING)
        else:
            self._skip(_SCALAR)

    def _array(self, path: Path) -> None:
        index = 0
        self._skip(_BLANK)
        while not self._take("]"):
            self._lines[(*path, index)] = self._line_here()
            self._value((*path, index))
            self._skip(_BLANK)
            self._take(",")
            self._skip(_BLANK)
            index += 1

    def _inline_table(self, path: Path) -> None:
        self._skip(_BLANK)
        while not self._take("}"):
            self._key_and_value(path)
            self._skip(_BLANK)
            self._take(",")
            self._skip(_BLANK)


def _unquoted(key: str) -> str:
    """A quoted key without quotes; escapes are resolved as TOML does."""
    return key if key[0] not in "\"'" else str(tomllib.loads(f"key = {key}")["key"])


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
