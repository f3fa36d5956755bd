"""Checks of the weights φ of one point."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw_testing.check import Inapplicable
from mpmfw_testing.searching import hypothesis
from mpmfw_testing.shape.cases import (
    AXES,
    MIDDLE,
    of_one_point,
    one_point,
    points,
    require,
    search_dimensions,
    two_points,
    within,
)
from mpmfw_testing.shape.placement import Placement
from mpmfw_testing.shape.sums import dense, entries_of, linear_error, spread, unity_error
from mpmfw_testing.subject import Subject

#: Rounding of sums of at most 64 products of order 1.
ROUNDING = 1e-12


@of_one_point
def partition_of_unity(placed: Placement) -> None:
    """The weights of a point add up to 1, in every dimension. |Σ φ − 1| ≤ 1e-12: rounding alone; a part of a
    point's mass would otherwise be lost or made."""
    error = unity_error(placed.table(), 1)
    require(error, ROUNDING, "the weights of a point do not add up to 1: |Σ φ − 1|", placed, 1)


@of_one_point
def linear_reproduction(placed: Placement) -> None:
    """The weights' centroid is the point: Σ φ x_i = x_p, the centroid of its domain. |Σ φ x_i − x_p| ≤ 1e-12
    h: rounding alone.

    For a function that is averaged over a domain x_p is the domain's centroid, which is where layouts put
    points. Without it a linear velocity is read wrongly, and angular momentum changes with every transfer.
    """
    error = linear_error(placed.table(), 1, placed.particles.position[1], placed.grid)
    message = "the weights' centroid is not the point: |Σ φ x_i − x_p| in cells"
    require(error, ROUNDING, message, placed, 1)


@of_one_point
def non_negative(placed: Placement) -> None:
    """No weight is negative, so that lumped masses are positive. φ ≥ −1e-15, rounding alone: a negative
    weight can make a node's lumped mass zero or negative."""
    table = placed.table()
    least = float(table.weight[entries_of(table, 1)].min())
    require(-least, 1e-15, "a weight is negative: −φ", placed, 1)


def continuity(subject: Subject) -> None:
    """Weights are continuous as a point or its domain crosses a face. |φ(x + ε) − φ(x − ε)| ≤ 1e-7 for ε =
    1e-9 h: a slope of up to 50 per cell passes, a jump does not.

    The point itself, or a face of its domain, crosses from one cell into the next.
    """
    draw = hypothesis().strategies

    def trial(dim: int, case: dict[str, Any]) -> None:
        centre, axis = MIDDLE + within(case, dim), AXES.index(case["across"])
        reach = (
            case["edge [cells]"] / 2.0 * {"point": 0.0, "front face": -1.0, "rear face": 1.0}[case["crosses"]]
        )
        centre[axis] = MIDDLE + reach
        sides = []
        for side in (-1e-9, 1e-9):
            moved = centre.copy()
            moved[axis] += side
            placed = two_points(subject, moved, case["edge [cells]"])
            sides.append(dense(placed.table(), 1, placed.grid)[0])
        jump = float(np.abs(sides[1] - sides[0]).max())
        require(jump, 1e-7, "a weight jumps as the point goes from one cell to the next", placed, 1)

    def cases(dim: int) -> dict[str, Any]:
        return {
            **points(dim),
            "across": draw.sampled_from(AXES[:dim]),
            "crosses": draw.sampled_from(("point", "front face", "rear face")),
        }

    search_dimensions(subject, cases, trial, examples=20)


def translation(subject: Subject) -> None:
    """A point that moves by whole cells keeps its weights and gradients. To 1e-12."""

    def trial(dim: int, case: dict[str, Any]) -> None:
        # away from roundings of positions, which decide on which side of a face a point is
        start = np.round(within(case, dim), 3)
        tables = []
        for shift in (0, case["cells moved"]):
            position = MIDDLE + start
            position[0] += shift
            position[-1] -= shift
            placed = two_points(subject, position, case["edge [cells]"])
            weight, gradient = dense(placed.table(), 1, placed.grid)
            back, axes = (-shift, shift), (0, dim - 1)
            tables.append((np.roll(weight, back, axes), np.roll(gradient, back, axes)))
        error = max(float(np.abs(a - b).max()) for a, b in zip(*tables, strict=True))
        require(error, ROUNDING, "the table changes as the point moves by whole cells", placed, 1)

    def cases(dim: int) -> dict[str, Any]:
        return {**points(dim), "cells moved": hypothesis().strategies.integers(1, 3)}

    search_dimensions(subject, cases, trial)


def regular_spread(subject: Subject) -> None:
    """Σ φ q qᵀ, q = x_i − x_p, can be inverted, or singular_spread is declared. The smallest eigenvalue of
    D_p = Σ φ q qᵀ, q = x_i − x_p, is at least 0.01 h².

    Affine transfers multiply by D⁻¹. A domain of a tenth of a cell, the smallest that is tried, leaves 0.025
    h² with GIMP; a D that vanishes somewhere must be declared with ``singular_spread``, so that ∇φ is taken
    in its place.
    """
    if subject.make().singular_spread:
        raise Inapplicable("singular_spread is declared: affine transfers take Σ v ∇φᵀ")

    def trial(dim: int, case: dict[str, Any]) -> None:
        placed = one_point(subject, case, dim)
        tensor = spread(placed.table(), 1, placed.particles.position[1], placed.grid)
        least = float(np.linalg.eigvalsh(0.5 * (tensor + tensor.T)).min())
        message = "D_p is singular, or nearly: −(least eigenvalue) in h²; is singular_spread to be declared?"
        require(-least, -0.01, message, placed, 1)

    search_dimensions(subject, points, trial)


#: In the order in which they are run.
CHECKS = (partition_of_unity, linear_reproduction, non_negative, continuity, translation, regular_spread)
