"""Checks of the functions of surface points."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.state.fields import FloatArray
from mpmfw_testing.check import Inapplicable, Violation
from mpmfw_testing.searching import ladder
from mpmfw_testing.shape.cases import (
    MIDDLE,
    coordinates,
    require,
    search_dimensions,
    searched,
    two_points,
    within,
)
from mpmfw_testing.shape.picture import picture_of
from mpmfw_testing.shape.placement import CELL, ORIGIN, Placement, boxes, place
from mpmfw_testing.shape.sums import at_nodes, gradient_at_nodes, linear_error, owners, unity_error
from mpmfw_testing.subject import Subject

#: Block of the divergence theorem: cells along its edge, points along a cell's edge, cells of the grid.
BLOCK, PER_CELL, GRID = 4, 4, 16
#: Points of the midpoint rule along each side of the block.
QUADRATURE = 200


def _shifts(_dim: int) -> dict[str, Any]:
    return {f"shifted along {axis} [cells]": ladder(0.0, 0.875, 8) for axis in "xy"}


@searched(coordinates, only=(2,))
def surface_sums(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """At a surface point Σ N = 1 and Σ N x_i = x_s (2D). |Σ N − 1| ≤ 1e-12 and |Σ N x_i − x_s| ≤ 1e-12 h:
    rounding alone.

    The first keeps contact forces when they are mapped to the grid, the second their moments, and both make
    the surface move with its body.
    """
    placed = two_points(subject, MIDDLE + within(case, dim), 0.5)
    placed.lay()
    position = placed.particles.position[1:].copy()
    table = placed.surface_table(position)
    message = "the weights of a surface point do not add up to 1: |Σ N − 1|"
    require(unity_error(table, 0), 1e-12, message, placed, 1)
    message = "the weights' centroid is not the surface point: |Σ N x_i − x_s| in cells"
    require(linear_error(table, 0, position[0], placed.grid), 1e-12, message, placed, 1)


@searched(_shifts, only=(2,), examples=10)
def divergence_theorem(subject: Subject, _dim: int, case: dict[str, Any]) -> None:
    """Σ V ∇φ = ∮ N n dS to the quadrature's error: the surface's functions match the points' (2D). Σ_i |Σ_p V
    ∇φ_i − ∮ N_i n dS| ≤ 0.05 Σ_i |∮ N_i n dS| for a square of 16 by 16 points anywhere on the grid.

    If it does not hold, pressure on the surface is not in balance with the same pressure inside: the stress
    at the surface is wrong while every displacement looks right. The surface integral is taken with 200
    points a side, whose own error is below 1e-4. What remains is the quadrature by four points a cell edge:
    nothing for GIMP, 0.008 for CPDI, 0.027 for quadratic and 0.011 for cubic B-splines at the worst place.
    The wrong partner leaves more, and denser points do not help: 0.16 and more for B-splines of another
    order, 0.49 for splines with linear functions.
    """
    placed, corner = _square(subject, case, PER_CELL)
    inside = gradient_at_nodes(placed.table(), placed.particles.volume, placed.grid)
    position, normal = _outline(corner)
    outside = at_nodes(placed.surface_table(position), normal, placed.grid)
    measured = float(np.abs(inside - outside).sum() / np.abs(outside).sum())
    if not measured <= 0.05:
        worst = placed.grid.position[np.abs(inside - outside).max(axis=1).argmax()]
        nearest = int(np.linalg.norm(placed.particles.position - worst, axis=1).argmin())
        raise Violation(
            "Σ V ∇φ is not ∮ N n dS: the surface's functions do not match the points'",
            {"worst node [cells]": np.rint((worst - placed.grid.lower) / CELL).astype(int).tolist()},
            picture_of(placed, nearest),
            measured=measured,
            bound=0.05,
        )


def boundary_mass(subject: Subject) -> None:
    """Nodes that boundary points reach have mass, or massless_boundary is declared (2D). At most a tenth of a
    boundary point's weight goes to nodes without mass, or ``massless_boundary`` is declared.

    A force on a node without mass is lost, or all acceleration. The core follows the declaration when it
    chooses how surfaces are mapped. Asked of a square of two points a cell edge: linear functions leave up to
    a quarter (and more at corners), quadratic B-splines 0.06, functions with domains that reach the boundary
    nothing.
    """
    if subject.make().massless_boundary:
        raise Inapplicable("massless_boundary is declared: surfaces are mapped by mass")

    def trial(_dim: int, case: dict[str, Any]) -> None:
        placed, corner = _square(subject, case, 2)
        mass = at_nodes(placed.table(), placed.particles.mass[:, None], placed.grid)[:, 0]
        position, _ = _outline(corner)
        table = placed.surface_table(position)
        lost = np.zeros(len(position))
        np.add.at(lost, owners(table), table.weight * (mass[table.nodes] <= 0.0))
        worst = position[int(lost.argmax())]
        nearest = int(np.linalg.norm(placed.particles.position - worst, axis=1).argmin())
        message = "a boundary point's weight goes to nodes without mass; is massless_boundary to be declared?"
        require(float(lost.max()), 0.1, message, placed, nearest)

    search_dimensions(subject, _shifts, trial, only=(2,), examples=10)


def _square(subject: Subject, case: dict[str, Any], per_cell: int) -> tuple[Placement, FloatArray]:
    """A square filled with square domains, and its lower corner (2,) [m]."""
    shift = np.array([case["shifted along x [cells]"], case["shifted along y [cells]"]])
    corner = MIDDLE - BLOCK / 2.0 + shift
    axis = (np.arange(BLOCK * per_cell) + 0.5) / per_cell
    lattice = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    placed = place(subject, [boxes(corner + lattice, 1.0 / per_cell)], GRID)
    return placed, np.array(ORIGIN[:2]) + CELL * corner


def _outline(lower: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points of the midpoint rule on the square's sides, and n dS there [m]."""
    edge = BLOCK * CELL
    along = (np.arange(QUADRATURE) + 0.5) / QUADRATURE * edge
    zero, full = np.zeros(QUADRATURE), np.full(QUADRATURE, edge)
    sides = [(along, zero, (0, -1)), (full, along, (1, 0)), (along, full, (0, 1)), (zero, along, (-1, 0))]
    position = np.concatenate([np.stack([x, y], axis=1) for x, y, _ in sides])
    normal = np.concatenate([np.tile(np.array(n, dtype=float), (QUADRATURE, 1)) for _, _, n in sides])
    return lower + position, normal * edge / QUADRATURE


#: In the order in which they are run.
CHECKS = (surface_sums, divergence_theorem, boundary_mass)
