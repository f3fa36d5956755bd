"""Kernels of the effects and of CPDI2 against plain NumPy, written from their formulas."""

import numpy as np
import numpy_twins as twin
import pytest

from mpmfw.effects.side_rows import SideTable, meet

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
