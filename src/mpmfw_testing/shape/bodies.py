"""Checks of deformed domains, of the forces of a body under constant stress, and of surface points."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from mpmfw.geometry.disc import Disc
from mpmfw.state.fields import AnyArray, FloatArray
from mpmfw.state.structs import Stencil
from mpmfw_testing.bench import dims_of
from mpmfw_testing.check import Inapplicable, Violation, within
from mpmfw_testing.shape.cases import (
    MIDDLE,
    one_point,
    points,
    sampled,
    searched,
    shift,
    shifts,
    two_points,
    velocity_gradient,
)
from mpmfw_testing.shape.placement import CELL, ORIGIN, Placement, boxes, lattice, place
from mpmfw_testing.shape.sums import (
    at_nodes,
    gradient_at_nodes,
    gradient_errors,
    linear_error,
    owners,
    unity_error,
)
from mpmfw_testing.subject import Subject

#: Edge of the domains of a block, which is the distance of its points [cells].
EDGES = (0.5, 0.45, 0.35)
#: Square of the divergence theorem: cells along its edge, and cells of the grid.
BLOCK, GRID = 4, 16
#: Points of the midpoint rule along each side of the square.
QUADRATURE = 200


@searched(points, examples=3, motions=True)
def deformed_sums(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """After stretch, shear and rotation weights and gradients still reproduce constant and linear fields.
    After a homogeneous deformation Σ φ = 1 and Σ φ x_i = x_p to 1e-11, Σ ∇φ = 0 and Σ x_i ⊗ ∇φ = 1 to 1e-9.

    Four steps of the motion, with ``update_particle_domains`` after each; the bounds are rounding.
    """
    placed = one_point(subject, case, dim)
    centre = placed.grid.lower + placed.grid.cell_size * (MIDDLE - 0.4)
    placed.deform(velocity_gradient(case["motion"], dim), centre)
    _require_sums(placed, placed.table(), 1)


@searched(shifts, only=(2,), examples=6)
def irregular_domains(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """Weights and gradients of irregular domains reproduce constant and linear fields (2D). The sums of
    ``deformed-sums``, to the same bounds, for every point of a disc with a fitted layout.

    Its domains are quadrilaterals of different shapes and sizes. Points are where the plug-in left them in
    ``setup``: at the centroids.
    """
    centre = np.array(ORIGIN[:dim]) + CELL * (MIDDLE + shift(case, dim))
    disc = Disc(centre=tuple(centre.tolist()), radius=1.6 * CELL).fitted(0.5 * CELL)
    placed = place(subject, [disc], 2 * MIDDLE)
    table = placed.table()
    for point in range(placed.particles.count):
        _require_sums(placed, table, point)


def _require_sums(placed: Placement, table: Stencil, point: int) -> None:
    at, case = placed.particles.position[point], {"point": point}
    within(unity_error(table, point), 1e-11, "|Σ φ − 1| of a deformed domain", case)
    error = linear_error(table, point, at, placed.grid)
    within(error, 1e-11, "|Σ φ x_i − x_p| of a deformed domain, in cells", case)
    constant, linear = gradient_errors(table, point, at, placed.grid)
    within(constant, 1e-9, "h |Σ ∇φ| of a deformed domain", case)
    within(linear, 1e-9, "|Σ x_i ⊗ ∇φ − 1| of a deformed domain", case)


@searched(lambda dim: {"edge [cells]": sampled(EDGES), **shifts(dim)}, examples=6)
def constant_stress(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """A constant stress makes no force inside a body. |Σ V ∇φ| ≤ 1e-11 h^(dim−1), rounding alone, at every
    node inside a block of square domains.

    Domains tile the block, whatever their edge. Of points without extent the sum is a quadrature, exact where
    each cell holds the same lattice of points: their distance is half a cell.
    """
    edge = float(case["edge [cells]"]) if _has_extent(subject) else EDGES[0]
    reach = _support(_block(subject, dim, 2.0, shift(case, dim), edge)) + 0.25
    block = _block(subject, dim, 2.0 * reach + 1.0, shift(case, dim), edge)
    _require_no_force(block, np.eye(dim), 1e-11)


@searched(shifts, examples=2, motions=True)
def constant_stress_deformed(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """A constant stress makes no force inside a body that was deformed homogeneously: domains follow F. |Σ V
    ∇φ| ≤ 1e-9 h^(dim−1) at every node inside a block that was deformed homogeneously.

    Domains that follow the deformation still tile the block, whatever F is. Asked of functions with domains
    alone: of points without extent the sum is a quadrature.
    """
    if not _has_extent(subject):
        raise Inapplicable("points have no extent (particle_reach is 0): Σ V ∇φ is a quadrature")
    gradient = velocity_gradient(case["motion"], dim)
    deformation = np.linalg.matrix_power(np.eye(dim) + gradient, 4)
    probe = _block(subject, dim, 2.0, shift(case, dim), EDGES[1])
    probe.deform(gradient, _centre(probe))
    # the pre-image of a box round a node, with room for the node to be anywhere in a cell
    box = _support(probe) + 0.75
    half = float(np.abs(np.linalg.inv(deformation)).sum(axis=1).max()) * box
    block = _block(subject, dim, 2.0 * half, shift(case, dim), EDGES[1])
    block.deform(gradient, _centre(block))
    _require_no_force(block, deformation, 1e-9)


def _has_extent(subject: Subject) -> bool:
    """Return whether the plug-in says that points have domains."""
    placed = two_points(subject, np.full(dims_of(subject)[0], MIDDLE + 0.3))
    return bool(np.any(placed.hook.particle_reach(particles=placed.particles)))


def _block(subject: Subject, dim: int, size: float, moved: FloatArray, edge: float) -> Placement:
    """Return a cube of ``size`` cells or a little more of square domains, on a grid with room round it."""
    count = int(np.ceil(size / edge))
    cells = 3 * int(np.ceil(size)) + 12
    corner = (cells - count * edge) // 2 + moved
    return place(subject, [boxes(corner + lattice(count, edge, dim), edge)], cells)


def _centre(block: Placement) -> FloatArray:
    centre: FloatArray = block.layouts[0].position.mean(axis=0)
    return centre


def _support(block: Placement) -> float:
    """Return the largest distance along an axis of a node with weight or gradient from its point [cells]."""
    table, points = block.table(), owners(block.table())
    used = slice(0, len(points))
    felt = (table.weight[used] != 0.0) | np.any(table.gradient[used] != 0.0, axis=1)
    distance = block.grid.position[table.nodes[used]] - block.particles.position[points]
    return float(np.abs(distance[felt]).max() / block.grid.cell_size)


def _inside(block: Placement, reach: float, deformation: FloatArray) -> AnyArray:
    """Return whether a box of half-edge ``reach`` round each node is in the block."""
    start, half = block.layouts[0].position, block.layouts[0].half_edges[0].diagonal()
    low, high = start.min(axis=0) - half, start.max(axis=0) + half
    inside = np.ones(len(block.grid.position), dtype=bool)
    for signs in itertools.product((-1.0, 1.0), repeat=block.dim):
        corner = block.grid.position + reach * block.grid.cell_size * np.array(signs) - _centre(block)
        before = corner @ np.linalg.inv(deformation).T + _centre(block)
        inside &= ((before >= low - 1e-9) & (before <= high + 1e-9)).all(axis=1)
    return inside


def _require_no_force(block: Placement, deformation: FloatArray, bound: float) -> None:
    grid, table, reach = block.grid, block.table(), _support(block)
    inside = _inside(block, reach, deformation)
    if not inside.any():
        raise Violation(f"a node {reach:.3g} cells away feels a point: the block has no inner node")
    force = gradient_at_nodes(table, block.particles.volume, grid) / grid.cell_size ** (block.dim - 1)
    force[~inside] = 0.0
    text = "a constant stress makes a force at a node inside the body: |Σ V ∇φ| / h^(dim−1)"
    within(np.abs(force).max(), bound, text, _worst(block, grid.position[np.abs(force).max(axis=1).argmax()]))


def _worst(placed: Placement, place: FloatArray) -> dict[str, object]:
    """Return a place [cells] and the point that is nearest, for a counterexample."""
    nearest = int(np.linalg.norm(placed.particles.position - place, axis=1).argmin())
    cells = (place - placed.grid.lower) / placed.grid.cell_size
    return {"worst place [cells]": cells.round(3).tolist(), "point": nearest}


@searched(shifts, only=(2,), examples=10)
def divergence_theorem(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """Σ V ∇φ = ∮ N n dS to the quadrature's error: the surface's functions match the points' (2D). Σ_i |Σ_p V
    ∇φ_i − ∮ N_i n dS| ≤ 0.05 Σ_i |∮ N_i n dS| for a square of 16 by 16 points anywhere on the grid.

    Otherwise pressure on the surface is not in balance with the same pressure inside: the stress at the
    surface is wrong while every displacement looks right. The quadrature by four points a cell edge leaves
    nothing with GIMP, 0.008 with CPDI, 0.027 with quadratic and 0.011 with cubic B-splines. The wrong partner
    leaves 0.16 and more, and denser points do not help.
    """
    placed, at, normal = _square(subject, shift(case, dim), 4)
    inside = gradient_at_nodes(placed.table(), placed.particles.volume, placed.grid)
    outside = at_nodes(placed.surface_table(at), normal, placed.grid)
    worst = placed.grid.position[np.abs(inside - outside).max(axis=1).argmax()]
    text = "Σ V ∇φ is not ∮ N n dS: the surface's functions do not match the points'"
    within(np.abs(inside - outside).sum() / np.abs(outside).sum(), 0.05, text, _worst(placed, worst))


@searched(shifts, only=(2,), examples=10)
def boundary_mass(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """Nodes that boundary points reach have mass, or massless_boundary is declared (2D). At most a tenth of a
    boundary point's weight goes to nodes without mass.

    A force on a node without mass is lost, or all acceleration. The core follows the declaration when it
    chooses how surfaces are mapped. With two points a cell edge linear functions leave up to a quarter,
    quadratic B-splines 0.06, functions with domains that reach the boundary nothing.
    """
    if subject.make().massless_boundary:
        raise Inapplicable("massless_boundary is declared: surfaces are mapped by mass")
    placed, at, _ = _square(subject, shift(case, dim), 2)
    mass = at_nodes(placed.table(), placed.particles.mass[:, None], placed.grid)[:, 0]
    table, lost = placed.surface_table(at), np.zeros(len(at))
    np.add.at(lost, owners(table), table.weight * (mass[table.nodes] <= 0.0))
    text = "a boundary point's weight goes to nodes without mass; is massless_boundary to be declared?"
    within(lost.max(), 0.1, text, _worst(placed, at[lost.argmax()]))


def _square(subject: Subject, moved: FloatArray, per_cell: int) -> tuple[Placement, FloatArray, FloatArray]:
    """Return a square filled with square domains, points (n, 2) [m] of the midpoint rule on its sides, and
    n dS there (n, 2) [m].
    """
    corner, edge = MIDDLE - BLOCK / 2.0 + moved, BLOCK * CELL
    layout = boxes(corner + lattice(BLOCK * per_cell, 1.0 / per_cell, 2), 1.0 / per_cell)
    along = (np.arange(QUADRATURE) + 0.5) / QUADRATURE * edge
    zero, full = np.zeros(QUADRATURE), np.full(QUADRATURE, edge)
    sides = [(along, zero, (0, -1)), (full, along, (1, 0)), (along, full, (0, 1)), (zero, along, (-1, 0))]
    at = np.concatenate([np.stack([x, y], axis=1) for x, y, _ in sides])
    normal = np.repeat(np.array([n for _, _, n in sides], dtype=float), QUADRATURE, axis=0)
    lower = np.array(ORIGIN[:2]) + CELL * corner
    return place(subject, [layout], GRID), lower + at, normal * edge / QUADRATURE


#: In the order in which they are run.
CHECKS = (
    deformed_sums, irregular_domains, constant_stress, constant_stress_deformed,
    divergence_theorem, boundary_mass,
)  # fmt: skip
