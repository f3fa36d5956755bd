"""The solver alone: two masses, and a random problem against its own conditions."""

from __future__ import annotations

import numpy as np
import pytest
from mpmfw_surface_impulse.solver import solve


def run(rows, mass, velocity, target, friction, sweeps=400, tolerance=1e-13):
    """Solve for rows of {node: a}; normals along x. Returns impulses (n, 2), velocities, and what the solver returns."""
    n = len(rows)
    start = np.cumsum([0, *(len(row) for row in rows)]).astype(np.int64)
    node = np.concatenate([list(row) for row in rows]).astype(np.int64)
    share = np.concatenate([list(row.values()) for row in rows]).astype(float)
    compliance = np.array([sum(a * a / mass[i] for i, a in row.items()) for row in rows])
    momentum, impulse = mass[:, None] * velocity, np.zeros((n, 2))
    said = solve(
        np.zeros(n, dtype=np.int64), start, node, share, np.zeros_like(share), np.tile([1.0, 0.0], (n, 1)),
        compliance, compliance, target, np.full(n, friction), mass, momentum, np.empty_like(momentum),
        impulse, np.empty_like(impulse), np.empty_like(impulse), tolerance, sweeps,
    )  # fmt: skip
    return impulse, momentum / mass[:, None], said


MASS = np.array([2.0, 3.0])
REDUCED = 1.2


def pair(approach, slide, friction, target=0.0):
    """Node 0 meets node 1 along −x."""
    velocity = np.array([[-approach, slide], [0.0, 0.0]])
    impulse, velocity, _ = run([{0: 1.0, 1: -1.0}], MASS, velocity, np.array([target]), friction)
    return impulse[0], velocity[0] - velocity[1]


def test_plastic_impact_of_two_masses():
    impulse, relative = pair(1.0, 0.0, 0.0)
    np.testing.assert_allclose(impulse, [REDUCED, 0.0])
    np.testing.assert_allclose(relative, 0.0, atol=1e-15)


def test_gap_that_is_left_may_close():
    impulse, relative = pair(1.0, 0.0, 0.0, target=0.4)
    np.testing.assert_allclose(impulse, [0.6 * REDUCED, 0.0])
    assert relative[0] == pytest.approx(-0.4)


def test_parting_masses_feel_nothing():
    impulse, relative = pair(-1.0, 0.5, 0.5)
    assert not impulse.any()
    np.testing.assert_array_equal(relative, [1.0, 0.5])


@pytest.mark.parametrize(
    ("slide", "expected"), [(0.2, -0.2 * REDUCED), (5.0, -0.3 * REDUCED), (-5.0, 0.3 * REDUCED)]
)
def test_stick_and_slip(slide, expected):
    """λ_t stops the slide, up to μ λ_n."""
    impulse, relative = pair(1.0, slide, 0.3)
    assert impulse[1] == pytest.approx(expected)
    assert relative[1] == pytest.approx(slide + expected / REDUCED, abs=1e-15)


def test_complementarity_of_a_coupled_problem():
    """0 ≤ λ_n ⟂ u_n + b ≥ 0 and Coulomb's cone in every row; rows share nodes, two of them are the same."""
    rng = np.random.default_rng(1)
    mass = rng.uniform(0.5, 2.0, 20)
    rows = []
    for _ in range(12):
        slave, master = rng.choice(10, 2, replace=False), 10 + rng.choice(10, 2, replace=False)
        w, xi = rng.uniform(size=2)
        rows.append(dict(zip([*slave, *master], [w, 1.0 - w, xi - 1.0, -xi], strict=True)))
    rows.append(rows[0])
    target, friction = rng.uniform(0.0, 0.3, len(rows)), 0.4
    impulse, velocity, (_, change) = run(rows, mass, rng.normal(size=(20, 2)), target, friction, sweeps=4000)
    assert change <= 1e-13
    u = np.array([sum(a * velocity[i] for i, a in row.items()) for row in rows])
    normal, tangential = impulse.T
    assert normal.min() >= 0.0
    assert normal.max() > 0.0
    assert (u[:, 0] + target).min() > -1e-11
    np.testing.assert_allclose(normal * (u[:, 0] + target), 0.0, atol=1e-11)
    assert (np.abs(tangential) <= friction * normal * (1.0 + 1e-12)).all()
    inside = np.abs(tangential) < friction * normal * (1.0 - 1e-9)
    np.testing.assert_allclose(u[inside, 1], 0.0, atol=1e-11)
    assert (tangential * u[:, 1] <= 1e-11).all()


def test_impulses_are_equal_and_opposite():
    velocity = np.array([[-1.0, 0.3], [0.0, 0.0]])
    _, after, _ = run([{0: 1.0, 1: -1.0}], MASS, velocity, np.zeros(1), 0.2)
    np.testing.assert_allclose(MASS @ after, MASS @ velocity, rtol=1e-15)
