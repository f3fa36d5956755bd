"""Sides of one body that prescribe two motions of the same nodes, or run into each other."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.scene.bodies import Body, Side
from mpmfw.scene.problem import Path, Problem
from mpmfw.units import TimeTable

if TYPE_CHECKING:
    from mpmfw.scene.scene import Scene

#: Axis of the body across each side, and the sides at its upper end.
AXIS = {"left": 0, "right": 0, "bottom": 1, "top": 1, "back": 2, "front": 2}
UPPER = ("right", "top", "front")


def rows_of(velocity: Any) -> tuple[Any, ...]:
    """Return the rows (t, v_x, v_y[, v_z]) of a side's velocity, one of a constant one."""
    return velocity if isinstance(velocity[0], tuple) else ((0.0, *velocity),)


def motion_of(side: Side, dim: int) -> TimeTable:
    """Return the prescribed velocity of a side, (dim,) [m/s]; NaN for a component that is free."""
    if side.velocity is not None:
        return TimeTable([[np.nan if v == "free" else v for v in row] for row in rows_of(side.velocity)])
    fixed = "xyz" if side.fixed is True else side.fixed or ()
    return TimeTable.constant([0.0 if name in fixed else np.nan for name in "xyz"[:dim]])


def side_labels(scene: Scene) -> tuple[str, ...]:
    """Return the labels ``body-side`` of prescribed sides, once each."""
    held = [(name, side) for name, body in scene.bodies.items() for side in body.sides if not side.is_loaded]
    return tuple(dict.fromkeys(f"{name}-{side.side}" for name, side in held))


def check_sides(body: Body, path: Path, dim: int, end: float) -> Iterator[Problem]:
    """Yield contradictions between the prescribed sides of a body at ``path``, until time ``end`` [s]."""
    plane = [(index, side) for index, side in enumerate(body.sides) if side.side in AXIS]
    for (_, first), (index, second) in itertools.combinations(plane, 2):
        at = (*path, "sides", index)
        if AXIS[first.side] == AXIS[second.side] and first.side != second.side:
            if text := _meeting(body, first, second, dim, end):
                yield Problem(at, text)
        elif first.side == second.side or body.geometry.type in ("rectangle", "box"):
            yield from _contradicting(first, second, at, dim)


def _contradicting(first: Side, second: Side, at: Path, dim: int) -> Iterator[Problem]:
    """Return components that both sides prescribe, with different values, on nodes that they share."""
    where = "" if first.side == second.side else ", with which it shares a corner,"
    one, other = motion_of(first, dim), motion_of(second, dim)
    times = np.union1d(one.times, other.times)
    values = np.array([[table.at(time) for table in (one, other)] for time in times])
    for axis in range(dim):
        own, given = values[:, :, axis].T
        if (differ := ~np.isnan(own + given) & (own != given)).any():
            k, name = differ.argmax(), "xyz"[axis]
            when = f" at {times[k]:g} s" if len(times) > 1 else ""
            message = (
                f"prescribes {given[k]:g} m/s along {name}{when}, but side '{first.side}'{where} prescribes "
                f"{own[k]:g} m/s; expected the same value, or '{name}' free on one of them"
            )
            yield Problem(at, message)


def _meeting(body: Body, first: Side, second: Side, dim: int, end: float) -> str:
    """Return when two opposite sides meet; empty if they do not before the end."""
    lower, upper = (second, first) if first.side in UPPER else (first, second)
    if body.geometry.type == "mesh":
        return ""
    axis, below, above = AXIS[lower.side], motion_of(lower, dim), motion_of(upper, dim)
    low, high = body.geometry.bounds[:, axis]
    times = np.union1d(np.linspace(0.0, end, 101), [*below.times, *above.times])
    times = times[(times >= 0.0) & (times <= end)]
    approach = np.array([(below.at(time) - above.at(time))[axis] for time in times])
    travelled = np.append(0.0, np.cumsum(0.5 * np.diff(times) * (approach[1:] + approach[:-1])))
    k = int((travelled >= high - low).argmax())
    if k == 0:
        return ""
    time = np.interp(high - low, travelled[k - 1 : k + 1], times[k - 1 : k + 1])
    return (
        f"meets side '{first.side}' at {time:.4g} s, before time.end: their velocities "
        f"compress the body to nothing; expected time.end, which is {end:g} s, to be earlier"
    )
