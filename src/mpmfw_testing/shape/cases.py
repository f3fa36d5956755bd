"""Where a point may be, and how a body may be deformed: the cases that checks search."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.bench import dims_of
from mpmfw_testing.check import Inapplicable
from mpmfw_testing.searching import hypothesis, ladder, search
from mpmfw_testing.shape.placement import Placement, boxes, place
from mpmfw_testing.subject import Subject

AXES = "xyz"
#: Cells along each axis of the grid that a single point is placed on, and the cell that it is placed in.
CELLS, MIDDLE = 16, 8
#: Position within a cell, the simplest first: inside, on faces and middles, and one rounding error beside
#: them.
WITHIN = (0.3, 0.5, 0.25, 0.75, 0.0, 0.9, 0.05, 1.0 / 3.0, 1e-16, 1.0 - 2.0**-53, 0.5 + 2.0**-53, 0.618)
#: Edge of a point's domain [cells].
EDGES = (0.5, 0.25, 1.0, 0.1, 1.0 / 3.0)
#: Motions, by their velocity gradient; four steps of it make the deformation.
MOTIONS = ("stretch", "compression", "shear", "rotation", "stretch and rotation")

#: A function of the dimension that returns strategies of a case's numbers.
Cases = Callable[[int], dict[str, Any]]
#: What a trial takes: the subject, the dimension, and the case.
Trial = Callable[[Subject, int, dict[str, Any]], None]


def sampled(values: Any) -> Any:
    """Return a strategy of these values, the simplest first."""
    return hypothesis().strategies.sampled_from(values)


def coordinates(dim: int) -> dict[str, Any]:
    """Return the position of a point within its cell, by axis."""
    return {f"{axis} [cells]": sampled(WITHIN) for axis in AXES[:dim]}


def position(case: Mapping[str, Any], dim: int) -> FloatArray:
    """Return the position that :func:`coordinates` drew, in the middle cell, (dim,) [cells]."""
    return MIDDLE + np.array([case[f"{axis} [cells]"] for axis in AXES[:dim]])


def points(dim: int) -> dict[str, Any]:
    """Return cases of one point: its position within the cell, and the edge of its domain."""
    return {**coordinates(dim), "edge [cells]": sampled(EDGES)}


def shifts(dim: int) -> dict[str, Any]:
    """Return cases of a body that lies anywhere on the grid."""
    return {f"shifted along {axis} [cells]": ladder(0.0, 0.875, 8) for axis in AXES[:dim]}


def shift(case: Mapping[str, Any], dim: int) -> FloatArray:
    """Return the vector that :func:`shifts` drew, (dim,) [cells]."""
    return np.array([case[f"shifted along {axis} [cells]"] for axis in AXES[:dim]])


def two_points(subject: Subject, at: FloatArray, edge: float = 0.5) -> Placement:
    """Return point 1 at ``at`` (dim,) [cells] with a domain of an ``edge`` [cells], and a point of another
    body elsewhere, which is point 0.
    """
    other = np.full((1, len(at)), MIDDLE - 1.6)
    other[0, 0] = MIDDLE + 2.2
    return place(subject, [boxes(other, 0.5), boxes(at[None, :], edge)], CELLS)


def one_point(subject: Subject, case: Mapping[str, Any], dim: int) -> Placement:
    """Return the point of a case of :func:`points`, as of :func:`two_points`."""
    return two_points(subject, position(case, dim), float(case["edge [cells]"]))


def velocity_gradient(motion: str, dim: int) -> FloatArray:
    """Return L of a motion, (dim, dim) [1/s]; four steps of 1 s stretch by 1.4 or turn by 30°."""
    stretch, spin, shear = np.zeros((3, dim, dim))
    stretch[0, 0], stretch[1, 1] = 0.09, -0.03
    spin[0, 1], spin[1, 0] = -0.13, 0.13
    shear[0, dim - 1] = 0.11
    compression = -0.8 * stretch - 0.02 * np.eye(dim)
    return {"stretch": stretch, "compression": compression, "shear": shear, "rotation": spin}.get(
        motion, spin + stretch
    )


def searched(
    cases: Cases = points, only: tuple[int, ...] = (2, 3), examples: int = 15, motions: bool = False
) -> Callable[[Trial], Callable[[Subject], None]]:
    """Make a check of a trial: search in every dimension that the shape function declares, ``only`` these.

    With ``motions`` each homogeneous motion is searched too, the case's ``motion``.
    """

    def check_of(trial: Trial) -> Callable[[Subject], None]:
        @functools.wraps(trial)
        def check(subject: Subject) -> None:
            dimensions = [dim for dim in dims_of(subject) if dim in only]
            if not dimensions:
                raise Inapplicable(f"the property is one of {' and '.join(f'{dim}D' for dim in only)}")
            just = hypothesis().strategies.just
            for motion in MOTIONS if motions else ("",):
                for dim in dimensions:
                    given = {"motion": just(motion)} if motions else {}
                    search(
                        {"dim": just(dim), **given, **cases(dim)},
                        lambda dim, **case: trial(subject, dim, case),
                        examples=examples,
                        most=8 * examples,
                    )

        return check

    return check_of


def of_one_point(look: Callable[[Placement], None]) -> Callable[[Subject], None]:
    """Make a check of a function that looks at point 1 of a placement."""

    @searched()
    @functools.wraps(look)
    def trial(subject: Subject, dim: int, case: dict[str, Any]) -> None:
        look(one_point(subject, case, dim))

    return trial
