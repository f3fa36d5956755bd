"""What is wrong with a scene, and where: one line each, all of them at once."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from mpmfw.errors import SceneProblem
from mpmfw.scene.locator import Locator, Path, dotted

#: Characters of a message about one problem.
LONGEST = 2000

Lines: TypeAlias = Locator | None


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong.

    Parameters
    ----------
    path
        Key that it is about; the table's path and the key's name where the key is missing.
    message
        What is wrong and what was expected.
    kind
        ``unknown`` and ``missing`` keys are recognised, because a misspelt key is both at once.
    suggestion
        Valid name that is nearest to an unknown key or name.
    override
        Override that could not be set at all.
    value, expected
        What was given, and what would have been valid, where it is known.
    """

    path: Path
    message: str
    kind: Literal["unknown", "missing", "value"] = "value"
    suggestion: str | None = None
    override: str | None = None
    value: Any = None
    expected: str = ""


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a scene came from, to say where a problem is.

    Parameters
    ----------
    name
        File name as the user gave it, or None for a mapping.
    locator
        Lines of the file's keys, or None for a mapping.
    overrides
        Keys of the overrides with the paths that they set; one that names a method with options sets several.
    said
        What the request calls an override, where it is not ``--set KEY``.
    """

    name: str | None
    locator: Lines
    overrides: Sequence[tuple[str, Path]]
    said: Mapping[str, str] = field(default_factory=dict)

    def located(self, problem: Problem) -> SceneProblem:
        """Return the problem with where its key was written: ``file.toml:12``, or the option that set it."""
        override = problem.override or self._override_of(problem.path, problem.message)
        key, source = dotted(problem.path), ""
        if override is not None:
            source = self.said.get(override, f"--set {override}")
            key = "" if key == override else key
        elif self.name is not None:
            source = self.name if self.locator is None else f"{self.name}:{self.locator.line(problem.path)}"
        return SceneProblem(
            _printable(problem.message),
            _printable(key),
            source,
            override or "",
            problem.value,
            problem.expected,
            problem.suggestion or "",
        )

    def line_number(self, problem: Problem) -> int:
        """Line for sorting; overrides come last."""
        if problem.override or self._override_of(problem.path, problem.message) is not None:
            return 1 << 30
        return 0 if self.locator is None else self.locator.line(problem.path)

    def _override_of(self, path: Path, message: str) -> str | None:
        """The last override that set this key or one around it, or that made the table it is missing from.

        What is wrong between the keys of a table is reported of the table: an override of one of them that
        the message names is meant."""
        if not path:
            return None
        overrides = self.overrides[::-1]
        for key, target in overrides:
            if path[: len(target)] == target:
                return key
        for key, target in overrides:
            named = re.search(rf"(?<![\w.]){re.escape(str(target[-1]))}(?!\w)", message)
            if named and len(target) > len(path) and target[: len(path)] == path:
                return key
        # The file has no such table: an override made it
        absent = self.locator is not None and len(path) > 1 and path[:-1] not in self.locator.lines
        made = (
            key
            for key, target in overrides
            if len(target) >= len(path) and target[: len(path) - 1] == path[:-1]
        )
        return next(made, None) if absent else None


def _printable(line: str) -> str:
    """The line as a terminal may show it: of a scene's own text, no control characters and no endless
    ones.
    """
    shown = "".join(c if c.isprintable() or c == "\n" else ascii(c)[1:-1] for c in line)
    return shown if len(shown) <= LONGEST else f"{shown[: LONGEST // 2]} … {shown[-LONGEST // 4 :]}"


def distinct(problems: Iterable[Problem]) -> list[Problem]:
    """One problem per cause: a misspelt required key is not also missing, and no key is reported twice."""
    found = list(problems)
    misspelt = {(*p.path[:-1], p.suggestion) for p in found if p.kind == "unknown"}
    kept: dict[Any, Problem] = {}
    for problem in found:
        if problem.kind == "missing" and problem.path in misspelt:
            continue
        identity = (problem.override, problem.path, problem.message if not problem.path else None)
        kept.setdefault(identity, problem)
    return list(kept.values())
