"""A check, its violation, and its outcome."""

from __future__ import annotations

import contextvars
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

if TYPE_CHECKING:
    from mpmfw_testing.subject import Subject

#: A function that draws a counterexample into matplotlib axes.
Picture: TypeAlias = Callable[[Any], None]

Status: TypeAlias = Literal["passed", "failed", "expected failure", "not applicable", "unexpectedly passed"]


@dataclass(frozen=True)
class LastCase:
    """The case that the kit ran last: its scene, number of steps, and a function that draws it."""

    scene: Mapping[str, Any] | None = None
    steps: int = 0
    draw: Callable[[Any, Mapping[str, object]], None] | None = None  #: takes axes and the counterexample


_last: contextvars.ContextVar[LastCase | None] = contextvars.ContextVar("last_case", default=None)


def remember(
    scene: Mapping[str, Any] | None = None,
    steps: int = 0,
    draw: Callable[[Any, Mapping[str, object]], None] | None = None,
) -> None:
    """Set the present case, which a violation keeps; without arguments there is none."""
    _last.set(LastCase(scene, steps, draw))


class Violation(AssertionError):
    """The property does not hold.

    Parameters
    ----------
    message
        What happened, in one or two sentences.
    counterexample
        The case in which it happened, as named numbers (or words); units belong to the names, ``gap [m]``.
    picture
        Draws the case into matplotlib axes, labels included; by default the kit's own picture, if any.
    measured, bound
        What was measured, and what it may be at most (or at least, if ``message`` says so).
    where
        Lines of the traceback, of an error that was raised.
    """

    def __init__(
        self,
        message: str,
        counterexample: Mapping[str, object] | None = None,
        picture: Picture | None = None,
        *,
        measured: float | None = None,
        bound: float | None = None,
        where: Sequence[str] = (),
    ) -> None:
        super().__init__(message)
        self.message = message
        self.counterexample: dict[str, object] = dict(counterexample or {})
        self.measured, self.bound, self.where = measured, bound, tuple(where)
        self.case = _last.get() or LastCase()
        self.picture: Picture | None = picture
        if picture is None and (draw := self.case.draw) is not None:
            self.picture = lambda axes: draw(axes, self.counterexample)

    def with_case(self, numbers: Mapping[str, object]) -> Violation:
        """Put the ``numbers`` of the case in front of the counterexample's own."""
        self.counterexample = {**numbers, **self.counterexample}
        return self

    @property
    def numbers(self) -> list[str]:
        """Lines with the measured value, if any, and the numbers of the counterexample."""
        lines = [f"{name} = {shown(value)}" for name, value in self.counterexample.items()]
        if self.measured is not None and self.bound is not None:
            lines.insert(0, f"measured {shown(self.measured)}, bound {shown(self.bound)}")
        return lines

    def __str__(self) -> str:
        return "\n".join([self.message, *(f"  {line}" for line in self.numbers), *self.where])


class Inapplicable(Exception):
    """The property does not apply to this plug-in; the message gives the reason."""


@dataclass(frozen=True)
class Check:
    """One property that a plug-in must have; :meth:`of` makes one of a function.

    ``run`` takes the :class:`~mpmfw_testing.subject.Subject` and returns if the property holds: None, or a
    note ("refuses: linear"). It raises :class:`Violation` if it does not hold, :class:`Inapplicable` if it
    does not apply. Its docstring states the bound and the reason for it.
    """

    name: str  #: short, in lower case with hyphens: ``partition-of-unity``
    property: str  #: one sentence that says what must hold
    run: Callable[[Subject], str | None]

    @classmethod
    def of(cls, function: Callable[[Subject], str | None]) -> Check:
        """Return the check of a function, whose name and docstring's first sentence state the property."""
        text = " ".join((function.__doc__ or "").split())
        return cls(function.__name__.replace("_", "-"), re.split(r"(?<=\.)\s", text)[0], function)


def within(measured: Any, bound: Any, message: str, case: Mapping[str, object] | None = None) -> None:
    """Raise a violation unless the number ``measured`` is at most ``bound``; NaN is beyond any bound."""
    if not measured <= bound:
        raise Violation(message, case, measured=float(measured), bound=float(bound))


@dataclass(frozen=True)
class Outcome:
    """Result of one check."""

    check: str  #: its name
    statement: str  #: what must hold
    status: Status  #: passed, failed, or why it is neither
    message: str = ""  #: of the violation, why the check does not apply, or a note
    violation: Violation | None = None  #: of the smallest case
    justification: str = ""  #: of an expected failure
    picture: Path | None = None  #: file of the counterexample's picture
    saved: tuple[Path, ...] = ()  #: its scene, and the program that runs it
    seconds: float = 0.0  #: wall time [s]
    same_as: str = ""  #: the first check that the same line of code made fail in the same way

    @property
    def wrong(self) -> bool:
        """Return True if the outcome was not expected."""
        return self.status in ("failed", "unexpectedly passed")

    @property
    def report(self) -> str:
        """The broken property, the smallest case that breaks it, and the place of its picture."""
        if self.same_as:
            return f"{self.check}: {self.status}, as {self.same_as}"
        lines = [f"{self.check}: {self.status}", f"  what must hold: {self.statement}"]
        if self.message:
            lines.append(f"  what happened: {self.message}")
        if self.violation is not None:
            told = {"smallest counterexample": self.violation.numbers, "where": self.violation.where}
            for name, text in told.items():
                lines += [f"  {name}:", *(f"    {line}" for line in text)] if text else []
        if self.justification:
            lines.append(f"  justification: {self.justification}")
        if self.picture is not None:
            lines.append(f"  picture: {self.picture}")
        for path in self.saved:
            lines.append(f"  run it: python {path}" if path.suffix == ".py" else f"  scene: {path}")
        return "\n".join(lines)


def shown(value: object) -> str:
    """Return numbers to six digits, everything else as it is."""
    if isinstance(value, float) or (hasattr(value, "dtype") and getattr(value, "ndim", 1) == 0):
        return f"{float(value):.6g}"  # type: ignore[arg-type]
    return str(value)
