"""Errors that users see: each has one message that says what is wrong, where, and what to do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any


class MpmfwError(Exception):
    """Base of all errors that mpmfw raises on purpose."""


@dataclass(frozen=True)
class SceneProblem:
    """One thing that is wrong with a request; its text is the line that a user reads."""

    message: str  #: what is wrong and what was expected
    key: str = ""  #: dotted key that it is about
    source: str = ""  #: where the key was written: file and line, or the option that set it
    override: str = ""  #: key that was set over the scene; empty where the scene itself is wrong
    value: Any = None  #: what was given, if it is known
    expected: str = ""  #: what would have been valid, if it is known
    nearest: str = ""  #: valid name that is nearest to the given one

    def __str__(self) -> str:
        return ": ".join(part for part in (self.source, self.key, self.message) if part)

    @property
    def plain(self) -> str:
        """Return the text without the option that set the key; file and line stay."""
        return str(replace(self, source="") if self.override else self)


class SceneError(MpmfwError):
    """The request was wrong: the scene, an option, a plug-in's name. Exit status 2.

    It is made of one ``message``, about a dotted ``key`` of the scene, or of several ``problems``. Attribute
    ``problems``: what is wrong, as data; the error's text has a line for each.
    """

    def __init__(self, message: str = "", problems: Sequence[SceneProblem] = (), key: str = "") -> None:
        self.problems = tuple(problems) or (SceneProblem(message, key),)
        super().__init__("\n".join(map(str, self.problems)))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), ("", self.problems)


class NoSuchFileError(SceneError):
    """A file does not exist, and no shipped scene or study has its name."""


class SimulationError(MpmfwError):
    """The run failed after it began; what was written so far is intact. Exit status 1.

    ``what`` happened, at which point (the ``index`` within a ``body``, the ``position`` [m]) and ``time``
    [s]; ``advice`` is what to try.
    """

    def __init__(
        self,
        what: str,
        *,
        body: str | None = None,
        index: int | None = None,
        position: Sequence[float] | None = None,
        time: float | None = None,
        advice: str | None = None,
    ) -> None:
        self.what, self.body, self.index, self.time, self.advice = what, body, index, time, advice
        #: What the run wrote before it failed (an xarray DataTree), set by :func:`mpmfw.run`.
        self.results: Any = None
        self.position = None if position is None else tuple(float(x) for x in position)
        place = None if position is None else ", ".join(f"{x:.6g}" for x in position)
        facts = {"body '{}'": body, "point {}": index, "at ({}) m": place, "at time {:.6g} s": time}
        where = ", ".join(form.format(fact) for form, fact in facts.items() if fact is not None)
        message = f"{what}: {where}" if where else what
        super().__init__(message + (f". Try: {advice}" if advice else ""))


class PastStabilityLimit(SimulationError):
    """A step became longer than a stability limit."""


class PluginError(SimulationError):
    """A plug-in failed during a run; ``what`` names plug-in, distribution and hook.

    ``step`` are the steps done before, ``time`` [s].
    """

    def __init__(self, what: str, *, step: int, time: float) -> None:
        self.step = step
        super().__init__(f"{what}, in step {step + 1}", time=time)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C or SIGTERM stopped a run; what was written so far is intact. Exit status 130 or 143.

    ``number`` is that of the signal; the message says what was written, and how to continue.
    """

    def __init__(self, number: int, said: str = "interrupted") -> None:
        self.number = number
        super().__init__(said)


class ResultsWarning(UserWarning):
    """A run ended with a remark on its results."""


def status_code(status: str) -> str:
    """Return the code of a status, which is ``code`` or ``code: text``: ``ok``, ``suspect``, ``failed``,
    ``refused`` …
    """
    return status.partition(":")[0]


def is_complete(status: str) -> bool:
    """Return whether a run with this status came to its end: ``ok``, or ``suspect: …``."""
    return status_code(status) in ("ok", "suspect")


class Diverged(Exception):
    """A point inverted, or a value became NaN; carries its index."""

    def __init__(self, what: str, index: int) -> None:
        super().__init__(what)
        self.index = index


class OutsideGrid(Exception):
    """A point left the background grid; carries its index."""

    def __init__(self, index: int, *, surface: bool = False) -> None:
        super().__init__(index)
        self.index = index
        self.surface = surface
