"""Kernels of the effects and of CPDI2 against plain NumPy, written from their formulas."""

import numpy as np
import numpy_twins as twin
import pytest

from mpmfw.api import Stencil
from mpmfw.effects.side_rows import SideTable, meet
from mpmfw_shape.cpdi2 import fill_cpdi2, move_corners
from support import as_grid

RNG = np.random.default_rng(7)
NODES, POINTS = 40, 25


@pytest.mark.parametrize("dim", [2, 3])
def test_rows_are_met_by_the_least_change_of_momentum(dim):
    """Against the solution of the constrained least squares, (M, Aᵀ; A, 0)."""
    spacing = (0.1,) * dim
    row, nodes, weights = twin.random_table(RNG, 6, NODES)
    mass, momentum = 0.1 + RNG.random(NODES), RNG.normal(size=(NODES, dim))
    side, target = np.array([0, 0, 1, 1, 0, 1]), np.array([1.0, 0.0, 1.0, 1.0, 1.0, 0.0])
    directions = np.array([np.linalg.qr(RNG.normal(size=(dim, dim)))[0], np.eye(dim)])
    velocity = np.array([[0.3, np.nan, -0.2][:dim], [np.nan, 0.1, 0.7][:dim]])
    rows, wanted = [], []
    for r, dense_row in enumerate(twin.matrix_of(row, nodes, weights, NODES)):
        for e in range(dim):
            if not np.isnan(velocity[side[r], e]):
                rows.append(np.outer(dense_row, directions[side[r], e]).ravel())
                wanted.append(target[r] * velocity[side[r], e])
    a, m = np.array(rows), np.repeat(mass, dim)
    v = momentum.ravel() / m
    v = v + (a / m).T @ np.linalg.solve(a @ (a / m).T, np.array(wanted) - a @ v)
    met = momentum.copy()
    conditions = side_table(6, 1).set(
        row=row, nodes=nodes.astype(np.int64), weights=weights, target=target, side=side
    )
    passes = meet(6, conditions, directions, velocity, 2000, 1e-13, 1.2, mass, met, spacing)
    assert passes < 2000
    np.testing.assert_allclose(met, (m * v).reshape(NODES, dim), atol=1e-10)


def side_table(rows, entries):
    """An empty table."""
    whole = {name: np.zeros(rows, dtype=np.int64) for name in ("row", "side")}
    real = {name: np.zeros(rows) for name in ("target", "compliance", "c", "distance")}
    return SideTable(
        nodes=np.zeros(entries, dtype=np.int64),
        weights=np.zeros(entries),
        impulse=np.zeros((rows, 3)),
        applied=np.zeros((0, 3)),
        **whole,
        **real,
    )


def quadrilaterals():
    """Random convex quadrilaterals (n, 4, 2), counter-clockwise, inside a grid of 8 × 8 unit cells."""
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return RNG.uniform(2, 6, (POINTS, 1, 2)) + 0.6 * square + RNG.uniform(-0.25, 0.25, (POINTS, 4, 2))


def integrals(corners, functions=40):
    """w_c = 1/V ∫ M_c dV and 1/V ∫ ∇M_c dV by a fine midpoint rule over the unit square."""
    s = (np.arange(functions) + 0.5) / functions
    u, v = (a.ravel() for a in np.meshgrid(s, s, indexing="ij"))
    m = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])
    du, dv = np.stack([-(1 - v), 1 - v, v, -v]), np.stack([-(1 - u), -u, u, 1 - u])
    jacobian = np.stack([np.stack([du.T @ corners, dv.T @ corners])], 0)[0]  # (2, n, 2): dx/du, dx/dv
    det = jacobian[0, :, 0] * jacobian[1, :, 1] - jacobian[0, :, 1] * jacobian[1, :, 0]
    grad_x = du * jacobian[1, :, 1] - dv * jacobian[0, :, 1]
    grad_y = dv * jacobian[0, :, 0] - du * jacobian[1, :, 0]
    return (m * det).sum(1) / det.sum(), np.column_stack([grad_x.sum(1), grad_y.sum(1)]) / det.sum()


def test_cpdi2_averages_over_the_quadrilateral_and_follows_the_grid():
    corners, n = quadrilaterals(), 9
    first, zeros, shape = np.array([0, POINTS]), np.zeros((1, 2), dtype=np.int64), np.full((1, 2), n)
    row, nodes = np.zeros(POINTS + 1, dtype=np.int64), np.zeros(16 * POINTS, dtype=np.int32)
    weight, gradient = np.zeros(16 * POINTS), np.zeros((16 * POINTS, 2))
    velocity = RNG.normal(size=(n * n, 2))
    offset = np.array([0, n * n])
    grid = as_grid(
        lower=np.zeros(2), window_lower=zeros, window_shape=shape, offset=offset, velocity=velocity
    )
    table = Stencil(row, nodes, weight, gradient)
    assert fill_cpdi2(first, corners, grid, 0, len(nodes), table, (1.0, 1.0)) == -1
    x = np.stack(np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), -1).reshape(-1, 2)
    hat = np.prod(np.maximum(1 - np.abs(corners[:, :, None] - x), 0.0), axis=-1)  # (points, corners, nodes)
    for p in range(POINTS):
        w, g = integrals(corners[p])
        phi, slope = np.zeros(n * n), np.zeros((n * n, 2))
        own = slice(row[p], row[p + 1])
        np.add.at(phi, nodes[own], weight[own])
        np.add.at(slope, nodes[own], gradient[own])
        np.testing.assert_allclose(phi, w @ hat[p], atol=2e-4)
        np.testing.assert_allclose(slope, np.einsum("cd,cn->nd", g, hat[p]), atol=2e-4)
    moved, position = corners.copy(), np.empty((POINTS, 2))
    along, across = (
        (corners[:, [1, 2]] - corners[:, [0, 3]]).sum(1),
        (corners[:, [2, 3]] - corners[:, [1, 0]]).sum(1),
    )
    half_edges = 0.25 * np.stack([along, across], axis=2)
    move_corners(first, grid, moved, position, half_edges, 0.05, (1.0, 1.0))
    np.testing.assert_allclose(moved, corners + 0.05 * hat @ velocity, rtol=1e-12, atol=1e-13)
    centroids = np.array([integrals(c)[0] @ c for c in moved])
    np.testing.assert_allclose(position, centroids, atol=2e-4)
