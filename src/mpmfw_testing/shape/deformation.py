"""Checks of deformed domains, and of the forces of a body under constant stress."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from mpmfw.geometry.disc import Disc
from mpmfw.state.fields import AnyArray, FloatArray
from mpmfw.state.structs import Stencil
from mpmfw_testing.check import Inapplicable, Violation
from mpmfw_testing.searching import hypothesis, ladder
from mpmfw_testing.shape.cases import (
    MIDDLE,
    dimensions_of,
    one_point,
    points,
    require,
    search_dimensions,
    search_motions,
    searched,
    two_points,
    velocity_gradient,
)
from mpmfw_testing.shape.picture import picture_of
from mpmfw_testing.shape.placement import CELL, ORIGIN, Placement, boxes, place
from mpmfw_testing.shape.sums import gradient_at_nodes, gradient_errors, linear_error, owners, unity_error
from mpmfw_testing.subject import Subject

#: Edge of the domains of a block, which is the distance of its points [cells].
EDGES = (0.5, 0.45, 0.35)


def _shifts(dim: int) -> dict[str, Any]:
    return {f"shifted along {axis} [cells]": ladder(0.0, 0.75, 7) for axis in "xyz"[:dim]}


def _shift(case: dict[str, Any], dim: int) -> FloatArray:
    return np.array([case[f"shifted along {axis} [cells]"] for axis in "xyz"[:dim]])


def deformed_sums(subject: Subject) -> None:
    """After stretch, shear and rotation weights and gradients still reproduce constant and linear fields.
    After a homogeneous deformation Σ φ = 1 and Σ φ x_i = x_p to 1e-11, Σ ∇φ = 0 and Σ x_i ⊗ ∇φ = 1 to 1e-9.

    Four steps of the motion, with ``update_particle_domains`` after each; the bounds are rounding, more of it
    than before the deformation since positions and domains have been summed up.
    """

    def trial(dim: int, case: dict[str, Any]) -> None:
        placed = one_point(subject, case, dim)
        centre = placed.grid.lower + placed.grid.cell_size * (MIDDLE - 0.4)
        placed.deform(velocity_gradient(case["motion"], dim), centre)
        _require_sums(placed, placed.table(), 1, placed.particles.position[1])

    search_motions(subject, points, trial, examples=3)


@searched(_shifts, only=(2,), examples=6)
def irregular_domains(subject: Subject, dim: int, case: dict[str, Any]) -> None:
    """Weights and gradients of irregular domains reproduce constant and linear fields (2D). The sums of
    ``deformed-sums``, to the same bounds, for every point of a disc with a fitted layout.

    Its domains are quadrilaterals of different shapes and sizes; parallelograms of the same centre and area
    stand for them in CPDI. Points are where the plug-in left them in ``setup``: at the centroids.
    """
    origin = np.array(ORIGIN[:dim])
    centre = origin + CELL * (MIDDLE + _shift(case, dim))
    disc = Disc(centre=tuple(centre.tolist()), radius=1.6 * CELL).fitted(0.5 * CELL)
    placed = place(subject, [disc], 2 * MIDDLE)
    table = placed.table()
    for point, position in enumerate(placed.particles.position):
        _require_sums(placed, table, point, position)


def constant_stress(subject: Subject) -> None:
    """A constant stress makes no force inside a body. |Σ V ∇φ| ≤ 1e-11 h^(dim−1), rounding alone, at every
    node inside a block of square domains.

    The block lies anywhere on the grid. Domains tile it, whatever their edge: the sum over them has no net
    boundary inside. Of points without extent the sum is a quadrature, exact where each cell holds the same
    lattice of points: their distance is half a cell.
    """
    edges = EDGES if _has_extent(subject) else EDGES[:1]

    def trial(dim: int, case: dict[str, Any]) -> None:
        edge, shift = float(case["edge [cells]"]), _shift(case, dim)
        reach = _support(_block(subject, dim, 2.0, shift, edge)) + 0.25
        block = _block(subject, dim, 2.0 * reach + 1.0, shift, edge)
        _require_no_force(block, np.eye(dim), 1e-11)

    def cases(dim: int) -> dict[str, Any]:
        return {"edge [cells]": hypothesis().strategies.sampled_from(edges), **_shifts(dim)}

    search_dimensions(subject, cases, trial, examples=6)


def constant_stress_deformed(subject: Subject) -> None:
    """A constant stress makes no force inside a body that was deformed homogeneously: domains follow F. |Σ V
    ∇φ| ≤ 1e-9 h^(dim−1) at every node inside a block that was deformed homogeneously.

    Domains that follow the deformation still tile the block: the sum over them has no net boundary inside,
    whatever F is. The bound is rounding. Asked of functions with domains alone: of points without extent the
    sum is a quadrature, which is exact on commensurate lattices only.
    """
    if not _has_extent(subject):
        raise Inapplicable("points have no extent (particle_reach is 0): Σ V ∇φ is a quadrature")

    def trial(dim: int, case: dict[str, Any]) -> None:
        gradient = velocity_gradient(case["motion"], dim)
        deformation = np.linalg.matrix_power(np.eye(dim) + gradient, 4)
        probe = _block(subject, dim, 2.0, _shift(case, dim), EDGES[1])
        probe.deform(gradient, _centre(probe))
        # the pre-image of a box round a node, with room for the node to be anywhere in a cell
        box = _support(probe) + 0.75
        half = float(np.abs(np.linalg.inv(deformation)).sum(axis=1).max()) * box
        block = _block(subject, dim, 2.0 * half, _shift(case, dim), EDGES[1])
        block.deform(gradient, _centre(block))
        _require_no_force(block, deformation, 1e-9)

    search_motions(subject, _shifts, trial, examples=2)


def _require_sums(placed: Placement, table: Stencil, point: int, position: FloatArray) -> None:
    require(unity_error(table, point), 1e-11, "|Σ φ − 1| of a deformed domain", placed, point)
    error = linear_error(table, point, position, placed.grid)
    require(error, 1e-11, "|Σ φ x_i − x_p| of a deformed domain, in cells", placed, point)
    constant, linear = gradient_errors(table, point, position, placed.grid)
    require(constant, 1e-9, "h |Σ ∇φ| of a deformed domain", placed, point)
    require(linear, 1e-9, "|Σ x_i ⊗ ∇φ − 1| of a deformed domain", placed, point)


def _has_extent(subject: Subject) -> bool:
    """Whether the plug-in says that points have domains."""
    dim = dimensions_of(subject)[0]
    placed = two_points(subject, np.full(dim, MIDDLE + 0.3), 0.5)
    return bool(np.any(placed.hook.particle_reach(particles=placed.particles)))


def _block(subject: Subject, dim: int, size: float, shift: FloatArray, edge: float = EDGES[0]) -> Placement:
    """A cube of ``size`` cells or a little more on a grid with room round it, filled with square domains."""
    count = int(np.ceil(size / edge))
    axis = (np.arange(count) + 0.5) * edge
    lattice = np.stack(np.meshgrid(*[axis] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    cells = 3 * int(np.ceil(size)) + 12
    corner = (cells - count * edge) // 2 + shift
    return place(subject, [boxes(corner + lattice, edge)], cells)


def _centre(block: Placement) -> FloatArray:
    centre: FloatArray = block.layouts[0].position.mean(axis=0)
    return centre


def _support(block: Placement) -> float:
    """Largest distance along an axis of a node with a weight or a gradient from its point [cells]."""
    table = block.table()
    used = len(owners(table))
    felt = (table.weight[:used] != 0.0) | np.any(table.gradient[:used] != 0.0, axis=1)
    distance = block.grid.position[table.nodes[:used]] - block.particles.position[owners(table)]
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
    worst = int(np.abs(force).max(axis=1).argmax())
    measured = float(np.abs(force).max())
    if not measured <= bound:
        nearest = int(np.linalg.norm(block.particles.position - grid.position[worst], axis=1).argmin())
        raise Violation(
            "a constant stress makes a force at a node inside the body: |Σ V ∇φ| / h^(dim−1)",
            {
                "node [cells]": np.rint((grid.position[worst] - grid.lower) / grid.cell_size)
                .astype(int)
                .tolist()
            },
            picture_of(block, nearest),
            measured=measured,
            bound=bound,
        )


#: In the order in which they are run.
CHECKS = (deformed_sums, irregular_domains, constant_stress, constant_stress_deformed)
