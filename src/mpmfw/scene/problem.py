"""Problems of a scene and their places: one line each, all at once."""

from __future__ import annotations

import bisect
import functools
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Literal

from mpmfw.errors import SceneProblem

Path = tuple[str | int, ...]

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
#: Brackets, and what may hold some that count for nothing: strings and comments.
_TOKEN = re.compile(
    r'"""(?:\\.|[^\\])*?"""(?:"{0,2}(?!"))|\'\'\'.*?\'\'\'(?:\'{0,2}(?!\'))|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\''
    r"|#[^\n]*|[\[\]{}]",
    re.S,
)


class Locator:
    """Lines of the keys of one valid TOML document."""

    def __init__(self, text: str) -> None:
        self._lines = tuple(text.replace("\r\n", "\n").split("\n"))

    def holds(self, path: Path) -> bool:
        """Return True if the document has this key."""
        return _holds(_parsed(self._lines, len(self._lines))[1], path)

    def line(self, path: Path) -> int:
        """Return the line (from 1) of the key, or of the nearest table or array around it; 1 for the root."""
        while path and not self.holds(path):
            path = path[:-1]
        header, counts = f"[{dotted(path)}]", range(1, len(self._lines) + 1)
        if not path:
            return 1
        if header in self._lines:  # a part of the table may stand before it
            return self._lines.index(header) + 1
        place = bisect.bisect_left(counts, True, key=lambda n: _holds(_parsed(self._lines, n)[1], path))
        begin = _parsed(self._lines, place)[0]
        while self._lines[begin].lstrip()[:1] in ("", "#"):
            begin += 1
        return begin + 1


@functools.lru_cache(maxsize=256)
def _parsed(lines: tuple[str, ...], count: int) -> tuple[int, Mapping[str, Any]]:
    """Parse the first lines, without the last ones if these begin a string; return their number as well."""
    while count:
        text = "\n".join(lines[:count])
        ends: list[str] = []
        for token in _TOKEN.findall(text):
            if token in ("[", "{"):
                ends.append("]" if token == "[" else "}")
            elif token in ("]", "}") and ends:
                ends.pop()
        with suppress(tomllib.TOMLDecodeError, RecursionError):
            return count, tomllib.loads(f"{text}\n{''.join(reversed(ends))}")
        count -= 1
    return 0, {}


def _holds(document: Any, path: Path) -> bool:
    for part in path:
        try:
            document = document[part]
        except (LookupError, TypeError):
            return False
    return True


def dotted(path: Path) -> str:
    """Return the path as a user writes it: ``contact.pairs[0].friction``."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            quoted = part.replace("\\", "\\\\").replace('"', '\\"')
            name = part if _BARE_KEY.fullmatch(part) else f'"{quoted}"'
            text += f".{name}" if text else name
    return text


#: Characters of a message about one problem.
LONGEST = 2000


@dataclass(frozen=True, slots=True)
class Problem:
    """One problem of a scene."""

    path: Path  #: key; if it is missing, the table's path and its name
    message: str  #: what is wrong and what was expected
    kind: Literal["unknown", "missing", "value"] = "value"  #: a misspelt key is both unknown and missing
    suggestion: str | None = None  #: valid name that is nearest to an unknown key or name
    override: str | None = None  #: override that could not be set at all
    value: Any = None  #: the given value, if known
    expected: str = ""  #: valid values, if known
    keys: tuple[str, ...] = ()  #: keys of a table that contradict each other


def one_form(path: Path, given: Iterable[str], *forms: str) -> Iterator[Problem]:
    """Refuse keys of a table that are not those of one of the ``forms``, such as ``mass and inertia``."""
    keys = sorted(given)
    if set(keys) not in [set(form.split(" and ")) for form in forms]:
        text = f"has {' and '.join(keys) or 'no key'}; expected exactly one of: {', '.join(forms)}"
        yield Problem(path, text, keys=tuple(keys))


@dataclass(frozen=True, slots=True)
class Origin:
    """Source of a scene; gives problems their place."""

    name: str | None  #: file name as the user gave it, or None for a mapping
    locator: Locator | None  #: lines of the file's keys, or None for a mapping
    overrides: Sequence[tuple[str, Path]]  #: keys of the overrides, with each path that they set
    said: Mapping[str, str] = field(default_factory=dict)  #: names of overrides that are not ``--set KEY``

    def located(self, problem: Problem) -> SceneProblem:
        """Return the problem with its place: ``file.toml:12``, or the option that set its key."""
        override = problem.override or self._override_of(problem)
        key, source = dotted(problem.path), ""
        if override is not None:
            source = self.said.get(override, f"--set {override}")
            key = "" if key == override else key
        elif self.name is not None:
            source = self.name if self.locator is None else f"{self.name}:{self.locator.line(problem.path)}"
            inside = [key for key, target in self.overrides if target[: len(problem.path)] == problem.path]
            if inside:
                source += " with " + ", ".join(self.said.get(key, f"--set {key}") for key in inside)
        known = (problem.value, problem.expected, problem.suggestion or "")
        return SceneProblem(_printable(problem.message), _printable(key), source, override or "", *known)

    def line_number(self, problem: Problem) -> int:
        """Line for sorting; overrides come last."""
        if problem.override or self._override_of(problem) is not None:
            return 1 << 30
        return 0 if self.locator is None else self.locator.line(problem.path)

    def _override_of(self, problem: Problem) -> str | None:
        """Return the last override of the key, of a key around it, or of one of the keys in a table's
        problem.

        If the file does not have the table, return any override that created it."""
        path = problem.path
        between = [(*path, name) for name in problem.keys]
        absent = self.locator is not None and len(path) > 1 and not self.locator.holds(path[:-1])
        rules: tuple[Callable[[Path], bool], ...] = (
            lambda target: path[: len(target)] == target,
            lambda target: target in between,
            lambda target: absent and len(target) >= len(path) and target[: len(path) - 1] == path[:-1],
        )
        blamed = (key for holds in rules for key, target in self.overrides[::-1] if holds(target))
        return next(blamed, None) if path else None


def _printable(line: str) -> str:
    """Return a line without control characters, shortened, for a terminal."""
    shown = "".join(c if c.isprintable() or c == "\n" else ascii(c)[1:-1] for c in line)
    return shown if len(shown) <= LONGEST else f"{shown[: LONGEST // 2]} … {shown[-LONGEST // 4 :]}"


def distinct(problems: Iterable[Problem]) -> list[Problem]:
    """Keep one problem per cause: a misspelt required key is not also missing, no key is reported twice."""
    found = list(problems)
    misspelt = {(*p.path[:-1], p.suggestion) for p in found if p.kind == "unknown"}
    kept: dict[Any, Problem] = {}
    for problem in found:
        if problem.kind == "missing" and problem.path in misspelt:
            continue
        identity = (problem.override, problem.path, problem.message if not problem.path else None)
        kept.setdefault(identity, problem)
    return list(kept.values())
