"""Where a point may be, and how a body may be deformed: the cases that checks search."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Inapplicable, Violation
from mpmfw_testing.searching import hypothesis, search
from mpmfw_testing.shape.picture import picture_of
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


def dimensions_of(subject: Subject) -> tuple[int, ...]:
    """The dimensions that the shape function declares."""
    declared: tuple[int, ...] = tuple(subject.make().dimensions)
    return declared


def coordinates(dim: int) -> dict[str, Any]:
    """Position of a point within its cell, by axis."""
    draw = hypothesis().strategies.sampled_from
    return {f"{axis} [cells]": draw(WITHIN) for axis in AXES[:dim]}


def within(case: Mapping[str, Any], dim: int) -> FloatArray:
    """The position that :func:`coordinates` drew, (dim,)."""
    return np.array([case[f"{axis} [cells]"] for axis in AXES[:dim]])


def points(dim: int) -> dict[str, Any]:
    """Cases of one point: its position within the cell, and the edge of its domain."""
    return {**coordinates(dim), "edge [cells]": hypothesis().strategies.sampled_from(EDGES)}


def one_point(subject: Subject, case: Mapping[str, Any], dim: int) -> Placement:
    """The point of a case, which is point 1, and a body that is elsewhere, which is point 0."""
    return two_points(subject, MIDDLE + within(case, dim), float(case["edge [cells]"]))


def two_points(subject: Subject, position: FloatArray, edge: float) -> Placement:
    """A point at ``position`` (dim,) [cells], after another body's at a place of its own."""
    other = np.full((1, len(position)), MIDDLE - 1.6)
    other[0, 0] = MIDDLE + 2.2
    return place(subject, [boxes(other, 0.5), boxes(position[None, :], edge)], CELLS)


def velocity_gradient(motion: str, dim: int) -> FloatArray:
    """L of a motion, (dim, dim) [1/s]; four steps of 1 s stretch by 1.4 or turn by 30°."""
    stretch, spin = np.zeros((dim, dim)), np.zeros((dim, dim))
    stretch[0, 0], stretch[1, 1] = 0.09, -0.03
    spin[0, 1], spin[1, 0] = -0.13, 0.13
    if motion == "stretch":
        return stretch
    if motion == "compression":
        return -0.8 * stretch - 0.02 * np.eye(dim)
    if motion == "shear":
        shear = np.zeros((dim, dim))
        shear[0, dim - 1] = 0.11
        return shear
    return spin if motion == "rotation" else spin + stretch


def search_dimensions(
    subject: Subject,
    cases: Callable[[int], dict[str, Any]],
    trial: Callable[[int, dict[str, Any]], None],
    *,
    only: tuple[int, ...] = (2, 3),
    examples: int = 15,
) -> None:
    """Search in every dimension that the shape function declares; ``trial`` takes the dimension and the case.

    Raises
    ------
    Inapplicable
        The shape function works in none of the dimensions ``only``.
    """
    dimensions = [dim for dim in dimensions_of(subject) if dim in only]
    if not dimensions:
        raise Inapplicable(f"the property is one of {' and '.join(f'{dim}D' for dim in only)}")
    for dim in dimensions:

        def one(dim: int = dim, **case: Any) -> None:
            trial(dim, case)

        given = {"dim": hypothesis().strategies.just(dim), **cases(dim)}
        search(given, one, examples=examples, most=8 * examples)


def searched(
    cases: Callable[[int], dict[str, Any]] = points, only: tuple[int, ...] = (2, 3), examples: int = 15
) -> Callable[[Callable[[Subject, int, dict[str, Any]], None]], Callable[[Subject], None]]:
    """Make a check of a trial, by :func:`search_dimensions`; the trial takes the subject as well."""

    def check_of(trial: Callable[[Subject, int, dict[str, Any]], None]) -> Callable[[Subject], None]:
        @functools.wraps(trial)
        def check(subject: Subject) -> None:
            search_dimensions(subject, cases, functools.partial(trial, subject), only=only, examples=examples)

        return check

    return check_of


def of_one_point(look: Callable[[Placement], None]) -> Callable[[Subject], None]:
    """Make a check of a function that looks at point 1 of a placement."""

    @searched()
    @functools.wraps(look)
    def trial(subject: Subject, dim: int, case: dict[str, Any]) -> None:
        look(one_point(subject, case, dim))

    return trial


def search_motions(
    subject: Subject,
    cases: Callable[[int], dict[str, Any]],
    trial: Callable[[int, dict[str, Any]], None],
    *,
    examples: int,
) -> None:
    """Search in every dimension with every homogeneous motion, which is the case's ``motion``."""
    for motion in MOTIONS:
        given = {"motion": hypothesis().strategies.just(motion)}

        def moved(dim: int, given: dict[str, Any] = given) -> dict[str, Any]:
            return {**given, **cases(dim)}

        search_dimensions(subject, moved, trial, examples=examples)


def require(
    measured: float, bound: float, message: str, placement: Placement, point: int, **numbers: object
) -> None:
    """Raise a violation with the point's picture if ``measured`` is above ``bound`` or NaN."""
    if not measured <= bound:
        raise Violation(
            message, numbers, picture_of(placement, point), measured=float(measured), bound=float(bound)
        )
