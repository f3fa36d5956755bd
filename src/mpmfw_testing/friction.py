"""The checks of a friction law, on rows of contact that are made up."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mpmfw.contact.rows import ContactRows, FrictionLaw
from mpmfw.state.fields import AnyArray, FloatArray, IntArray
from mpmfw_testing.bench import Opened
from mpmfw_testing.check import Violation
from mpmfw_testing.generic import options, repeatable, runs, sent, unchanged
from mpmfw_testing.subject import Subject

#: μ of three pairs, and the length of a step [s].
MU, STEP = np.array([0.1, 0.5, 0.9]), 1e-4
#: Rows that are made up.
ROWS = 24
#: Relative difference that rounding makes.
ROUNDING = 1e-12


def rows_of(
    law: FrictionLaw, dim: int = 2, which: IntArray | None = None, turn: FloatArray | None = None
) -> ContactRows:
    """Return rows of all pairs, or ``which`` of them, turned by a matrix.

    They slide at up to 3 m/s, some of them are at rest. The results of a friction law are NaN before.
    """
    chosen = np.arange(ROWS) if which is None else which
    random = np.random.default_rng(1)
    normal, speed = random.normal(size=(2, ROWS, dim))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    motion = STEP * speed * (np.arange(ROWS) % 4 > 0)[:, None]
    rows = ContactRows(dim, couples=False)
    rows.allocate_friction(cohesion=law.cohesive)
    n, matrix = len(chosen), np.eye(dim) if turn is None else turn
    rows.count = n
    rows.pair[:n], rows.identity[:n] = (np.arange(ROWS) % len(MU))[chosen], chosen
    rows.sign[:n], rows.previous[:n] = 1.0, chosen
    rows.gap[:n], rows.area[:n] = -1e-4, 0.02 * (1.0 + 0.1 * chosen)
    rows.tributary_area[:n] = rows.area[:n]
    rows.normal[:n], rows.motion[:n] = normal[chosen] @ matrix.T, motion[chosen] @ matrix.T
    for array in (rows.friction, rows.cohesion):
        array[:] = np.nan
    return rows


def bounds(law: FrictionLaw, rows: ContactRows, mu: FloatArray = MU, dt: float = STEP) -> FloatArray:
    """Return μ and a of every row, (n, 2); a is 0 where the law has none."""
    law.slip_limit(rows, mu.copy(), dt)
    n = rows.count
    cohesion = rows.cohesion[:n] if len(rows.cohesion) else np.zeros(n)
    return np.column_stack([rows.friction[:n], cohesion])


def openings(subject: Subject) -> Iterator[Callable[[Any], Opened]]:  # noqa: ARG001
    """Yield rows in two and three dimensions, also in the first step, whose Δt is 0."""
    yield functools.partial(Opened, _all_bounds)


def _all_bounds(law: FrictionLaw) -> Iterator[tuple[str, AnyArray]]:
    for dim in (2, 3):
        for dt in (0.0, STEP):
            found = bounds(law, rows_of(law, dim), dt=dt)
            if (found < 0.0).any():
                raise Violation("a row has a bound that is negative", {"dim": dim, "step [s]": dt})
            yield f"bounds in {dim}D in a step of {dt} s", found


def changes_nothing_else(subject: Subject) -> None:
    """It writes friction and cohesion of the rows alone."""
    law, mu = subject.make(), MU.copy()
    rows = rows_of(law)
    with unchanged("the friction law", rows, but=("friction", "cohesion")):
        law.slip_limit(rows, mu, STEP)
    if not np.array_equal(mu, MU):
        raise Violation("the friction law changes μ of the pairs")


def each_for_itself(subject: Subject) -> None:
    """A row's bound is that of its own motion and pair. The same bits among fewer rows, and with another μ of
    other pairs."""
    whole, few = _bounds(subject), np.array([17, 3, 8, 12])
    _same(whole[few], _bounds(subject, which=few), "which other rows there are")
    for pair in range(len(MU)):
        own = np.arange(ROWS) % len(MU) == pair
        other = _bounds(subject, mu=np.where(np.arange(len(MU)) == pair, MU, 2.0 * MU))
        _same(whole[own], other[own], "the μ of other pairs")


def frame(subject: Subject) -> None:
    """Turned rows, and rows seen from the other side, have the same bound. To 1e-12."""
    turns = {"turned": np.array([[0.8, -0.6], [0.6, 0.8]]), "seen from the other side": -np.eye(2)}
    for name, turn in turns.items():
        _same(_bounds(subject), _bounds(subject, turn=turn), f"whether rows are {name}", ROUNDING)


def slip(subject: Subject) -> None:
    """The bound goes with the slip, not with the approach. Motion along the normal is not slip: with 1 m/s
    more of it the same to 1e-6, as rounding lets a row at rest slip."""
    law = subject.make()
    rows = rows_of(law)
    rows.motion[:ROWS] += STEP * rows.normal[:ROWS]
    _same(_bounds(subject), bounds(law, rows), "motion along the normal", 1e-6)


def share(subject: Subject) -> None:
    """The bound is that of the surface, however it is divided into rows. A row of a quarter of the area, with
    another number, has the same μ and a quarter of the cohesion, to 1e-12.

    Rows are nodes of a surface, or of the grid: a finer one has more of them, numbered otherwise.
    """
    law = subject.make()
    rows = rows_of(law)
    rows.area[:ROWS] *= 0.25
    rows.tributary_area[:ROWS] *= 0.25
    rows.identity[:ROWS] += 1
    found = bounds(law, rows) * np.array([1.0, 4.0])
    _same(_bounds(subject), found, "its number, or how finely the surface is divided", ROUNDING)


def units(subject: Subject) -> None:
    """The bound goes with the speed, however long a step is. Half the step has half the motion."""
    law = subject.make()
    rows = rows_of(law)
    rows.motion[:] *= 0.5
    _same(_bounds(subject), bounds(law, rows, dt=0.5 * STEP), "the length of the step", ROUNDING)


def _bounds(subject: Subject, mu: FloatArray = MU, **rows: Any) -> FloatArray:
    """Return the bounds of a fresh law for rows of :func:`rows_of`."""
    law = subject.make()
    return bounds(law, rows_of(law, **rows), mu)


def _same(expected: FloatArray, found: FloatArray, what: str, share: float = 0.0) -> None:
    """Raise a violation unless the bounds are the same."""
    apart = np.abs(found - expected).max(axis=1)
    allowed = share * np.abs(expected).max(axis=1)
    if not (apart <= allowed).all():
        row = int((apart - allowed).argmax())
        case = {
            "row": row, "friction and cohesion": found[row].tolist(), "instead of": expected[row].tolist()
        }  # fmt: skip
        raise Violation(f"the bound of a row depends on {what}", case)


#: Those first whose failure makes others fail as well.
CHECKS = (runs, changes_nothing_else, each_for_itself, repeatable, frame, slip, share, units, options, sent)
