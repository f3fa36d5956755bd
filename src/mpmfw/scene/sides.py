"""Sides of one body that prescribe two motions of the same nodes, or run into each other."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from mpmfw.scene.problem import Path, Problem
from mpmfw.scene.tables import Body, Side

#: Axis of the body across each side, and the sides at its upper end.
AXIS = {"left": 0, "right": 0, "bottom": 1, "top": 1, "back": 2, "front": 2}
UPPER = ("right", "top", "front")


def check_sides(body: Body, path: Path, dim: int, end: float) -> Iterator[Problem]:
    """Yield contradictions between the prescribed sides of a body at ``path``, until time ``end`` [s]."""
    plane = [(index, side) for index, side in enumerate(body.sides) if side.side in AXIS]
    for (_, first), (index, second) in itertools.combinations(plane, 2):
        at = (*path, "sides", index)
        if AXIS[first.side] == AXIS[second.side] and first.side != second.side:
            if text := _meeting(body, first, second, end):
                yield Problem(at, text)
        elif first.side == second.side or body.geometry.type in ("rectangle", "box"):
            yield from _contradicting(first, second, at, dim)


def _contradicting(first: Side, second: Side, at: Path, dim: int) -> Iterator[Problem]:
    """Return components that both sides prescribe, with different values, on nodes that they share."""
    where = "" if first.side == second.side else ", with which it shares a corner,"
    for axis in range(dim):
        one, other = _component(first, axis), _component(second, axis)
        if one is not None and other is not None and one != other:
            name = "xyz"[axis]
            message = (
                f"prescribes {other:g} m/s along {name}, but side '{first.side}'{where} prescribes {one:g} "
                f"m/s; expected the same value, or '{name}' free on one of them"
            )
            yield Problem(at, message)


def _meeting(body: Body, first: Side, second: Side, end: float) -> str:
    """Return when two opposite sides meet; empty if they do not before the end."""
    lower, upper = (second, first) if first.side in UPPER else (first, second)
    axis = AXIS[lower.side]
    below, above = _component(lower, axis), _component(upper, axis)
    if below is None or above is None or body.geometry.type == "mesh":
        return ""
    low, high = body.geometry.bounds[:, axis]
    approach = below - above
    if approach * end < high - low:
        return ""
    return (
        f"meets side '{first.side}' at {(high - low) / approach:.4g} s, before time.end: their velocities "
        f"compress the body to nothing; expected time.end, which is {end:g} s, to be earlier"
    )


def _component(side: Side, axis: int) -> float | None:
    """Return the prescribed velocity along an axis [m/s], None if the side leaves it free."""
    if side.velocity is not None and axis < len(side.velocity):
        value = side.velocity[axis]
        return None if isinstance(value, str) else float(value)
    if side.fixed is True or (side.fixed is not None and "xyz"[axis] in side.fixed):
        return 0.0
    return None
