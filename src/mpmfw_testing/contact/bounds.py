"""How a measured number is held against its bound, and how cases of meeting bodies are searched."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from mpmfw_testing.check import Picture, Violation
from mpmfw_testing.contact.meeting import NAMES, Meeting
from mpmfw_testing.searching import search


def within(
    measured: float,
    bound: float,
    message: str,
    case: Mapping[str, object] | None = None,
    picture: Picture | None = None,
) -> None:
    """Raise a violation unless ``measured`` is at most ``bound``; what is not a number is beyond any bound."""
    if not measured <= bound:
        raise Violation(message, case, picture, measured=float(measured), bound=float(bound))


def search_meetings(
    trial: Callable[[Meeting], None],
    cases: Mapping[str, Any],
    *,
    examples: int = 8,
    most: int = 40,
    **fixed: Any,
) -> None:
    """Try a property on meetings that differ in ``cases``; ``fixed`` numbers are the same in all.

    Raises
    ------
    Violation
        Of the smallest case that breaks it.
    """
    search(
        cases,
        lambda **numbers: trial(Meeting(**{**fixed, **numbers})),
        examples=examples,
        most=most,
        names=NAMES,
    )
