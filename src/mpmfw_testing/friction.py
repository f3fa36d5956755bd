"""The checks of a friction law: what it writes for rows of contact that are made up."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.contact.rows import ContactRows, FrictionLaw
from mpmfw.state.fields import FloatArray, IntArray
from mpmfw_testing.check import Violation
from mpmfw_testing.generic import unchanged
from mpmfw_testing.options import every_option_acts
from mpmfw_testing.sent import sent
from mpmfw_testing.subject import Subject

#: μ of three pairs, and the length of a step [s].
MU, STEP = np.array([0.1, 0.5, 0.9]), 1e-4
#: Rows that are made up.
ROWS = 24
#: Relative difference that rounding makes.
ROUNDING = 1e-12


def rows_of(
    law: FrictionLaw, dim: int, which: IntArray | None = None, turn: FloatArray | None = None
) -> ContactRows:
    """Rows of all pairs, that slide at up to 3 m/s, some of them at rest; ``which`` of them, turned by a
    matrix.

    What a friction law writes is NaN before.
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
    """μ and a of every row, (n, 2); a is 0 where the law has none."""
    law.slip_limit(rows, mu.copy(), dt)
    n = rows.count
    cohesion = rows.cohesion[:n] if len(rows.cohesion) else np.zeros(n)
    return np.column_stack([rows.friction[:n], cohesion])


def runs(subject: Subject) -> None:
    """Every row has a bound that is finite and not negative. Also in the first step, whose Δt is 0."""
    for dim in (2, 3):
        for dt in (0.0, STEP):
            law = subject.make()
            found = bounds(law, rows_of(law, dim), dt=dt)
            if not (np.isfinite(found).all() and (found >= 0.0).all()):
                row = int(np.flatnonzero(~(np.isfinite(found) & (found >= 0.0)).all(axis=1))[0])
                case = {"dim": dim, "step [s]": dt, "row": row, "friction and cohesion": found[row].tolist()}
                raise Violation("a row has no bound, or one that is negative or not finite", case)


def changes_nothing_else(subject: Subject) -> None:
    """It writes friction and cohesion of the rows alone."""
    law = subject.make()
    rows, mu = rows_of(law, 2), MU.copy()
    with unchanged("the friction law", rows, but=("friction", "cohesion")):
        law.slip_limit(rows, mu, STEP)
    if not np.array_equal(mu, MU):
        raise Violation("the friction law changes μ of the pairs")


def each_for_itself(subject: Subject) -> None:
    """A row's bound is that of its own motion and pair. The same bits among fewer rows, and with another μ of
    other pairs."""
    law = subject.make()
    whole, few = bounds(law, rows_of(law, 2)), np.array([17, 3, 8, 12])
    _same(whole[few], bounds(subject.make(), rows_of(law, 2, few)), "which other rows there are")
    for pair in range(len(MU)):
        other = np.where(np.arange(len(MU)) == pair, MU, 2.0 * MU)
        own = np.arange(ROWS) % len(MU) == pair
        _same(whole[own], bounds(subject.make(), rows_of(law, 2), other)[own], "the μ of other pairs")


def no_memory(subject: Subject) -> None:
    """The bound is a function of the rows. Asked again after others, the same bits: runs are resumed."""
    law = subject.make()
    first = bounds(law, rows_of(law, 2))
    bounds(law, rows_of(law, 2, np.array([5, 9])), 3.0 * MU, 10.0 * STEP)
    _same(first, bounds(law, rows_of(law, 2)), "what was asked before")


def frame(subject: Subject) -> None:
    """Turned rows, and rows seen from the other side, have the same bound. To 1e-12."""
    turns: dict[str, Any] = {
        "turned": np.array([[0.8, -0.6], [0.6, 0.8]]),
        "seen from the other side": -np.eye(2),
    }
    for what, matrix in turns.items():
        law = subject.make()
        first, second = (bounds(subject.make(), rows_of(law, 2, turn=turn)) for turn in (None, matrix))
        _same(first, second, f"whether rows are {what}", ROUNDING)


def slip(subject: Subject) -> None:
    """The bound goes with the slip, not with the approach. Motion along the normal is no slip: with 1 m/s
    more of it the same to 1e-6, as rounding lets a row at rest slip."""
    rows, law = rows_of(subject.make(), 2), subject.make()
    n = rows.count
    rows.motion[:n] += STEP * rows.normal[:n]
    _same(bounds(subject.make(), rows_of(law, 2)), bounds(law, rows), "motion along the normal", 1e-6)


def share(subject: Subject) -> None:
    """The bound is that of the surface, however it is divided into rows. A row of a quarter of the area, with
    another number, has the same μ and a quarter of the cohesion, to 1e-12.

    Rows are nodes of a surface, or of the grid: a finer one has more of them, numbered otherwise.
    """
    rows, law = rows_of(subject.make(), 2), subject.make()
    n = rows.count
    rows.area[:n] *= 0.25
    rows.tributary_area[:n] *= 0.25
    rows.identity[:n] += 1
    found = bounds(law, rows) * np.array([1.0, 4.0])
    _same(
        bounds(subject.make(), rows_of(law, 2)),
        found,
        "its number, or how finely the surface is divided",
        ROUNDING,
    )


def units(subject: Subject) -> None:
    """The bound goes with the speed, however long a step is. Half the step has half the motion."""
    law = subject.make()
    rows = rows_of(law, 2)
    rows.motion[:] *= 0.5
    _same(
        bounds(subject.make(), rows_of(law, 2)),
        bounds(law, rows, dt=0.5 * STEP),
        "the length of the step",
        ROUNDING,
    )


def options(subject: Subject) -> None:
    """Every option changes something or is refused."""

    def experiment(options: dict[str, Any]) -> str:
        law = subject.make(**options)
        return bounds(law, rows_of(law, 2)).tobytes().hex()

    every_option_acts(subject, [experiment])


def _same(expected: FloatArray, found: FloatArray, what: str, share: float = 0.0) -> None:
    """Raise a violation unless the bounds are the same."""
    apart = np.abs(found - expected).max(axis=1)
    allowed = share * np.abs(expected).max(axis=1)
    if not (apart <= allowed).all():
        row = int((apart - allowed).argmax())
        case = {
            "row": row,
            "friction and cohesion": found[row].tolist(),
            "instead of": expected[row].tolist(),
        }
        raise Violation(f"the bound of a row depends on {what}", case)


#: In the order in which they are run.
CHECKS = (runs, changes_nothing_else, each_for_itself, no_memory, frame, slip, share, units, options, sent)
