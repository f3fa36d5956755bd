"""Properties of every shape function, for random points, points on cell faces and grid lines, and deformed
domains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mpmfw.api import FloatArray, Grid, Particles, Stencil
from support import SHAPES, make_particles, make_shape, make_test_grid

#: What does not hold for which shape function; all else holds for all.
#:
#: - ``derivative``: ∇φ_ip is the derivative of φ_ip with respect to x_p. CPDI's gradient is the mean over the
#:   domain of the interpolated function's gradient, from the corners alone.
#: - ``smooth``: ∇φ_ip is continuous in x_p across cell faces.
EXCEPTIONS = {"derivative": {"cpdi"}, "smooth": {"linear"}}

N = 6  #: points per velocity field
SETTINGS = settings(max_examples=60)
EVERY_SHAPE = pytest.mark.parametrize("name", SHAPES)
DIMENSIONS = pytest.mark.parametrize("dim", [2, 3], ids=["2D", "3D"])


@dataclass
class Case:
    """Points in two windows, and the table of a shape function there."""

    grid: Grid
    particles: Particles
    table: Stencil

    def sum(self, entries: FloatArray) -> FloatArray:
        """Σ over each point's entries."""
        return np.add.reduceat(entries, self.table.row[:-1], axis=0)


def rotation(rng: np.random.Generator, dim: int) -> FloatArray:
    """Random orthogonal matrix with determinant 1."""
    q, _ = np.linalg.qr(rng.normal(size=(dim, dim)))
    q[:, 0] *= np.sign(np.linalg.det(q))
    return q


def deformation(rng: np.random.Generator, dim: int) -> FloatArray:
    """Random F with principal stretches in 0.6 … 1.5 and det F in 0.3 … 3."""
    while True:
        stretches = rng.uniform(0.6, 1.5, dim)
        if 0.3 <= stretches.prod() <= 3.0:
            return rotation(rng, dim) @ np.diag(stretches) @ rotation(rng, dim)


#: Coordinate within a cell: anywhere, on faces and middles, and one rounding error beside them.
IN_CELL = st.one_of(
    st.floats(0.0, 1.0), st.sampled_from([0.0, 0.25, 0.5, 0.75, 1.0, 1e-16, 1.0 - 2.0**-53, 0.5 + 2.0**-53])
)


@st.composite
def layouts(draw, dim):
    """Grid with two different windows, and points in both."""
    h = draw(st.sampled_from([1.0, 0.1, 0.0025]))
    lower = h * np.array(draw(st.lists(st.sampled_from([0.0, -3.0, 0.7]), min_size=dim, max_size=dim)))
    first = draw(st.lists(st.integers(0, 4), min_size=2 * dim, max_size=2 * dim))
    shape = draw(st.lists(st.integers(7, 9), min_size=2 * dim, max_size=2 * dim))
    windows = [(first[:dim], shape[:dim]), (first[dim:], shape[dim:])]
    grid = make_test_grid(windows, cell_size=h, lower=lower)
    cells = np.array(draw(st.lists(st.integers(2, 3), min_size=2 * N * dim, max_size=2 * N * dim)))
    within = np.array(draw(st.lists(IN_CELL, min_size=2 * N * dim, max_size=2 * N * dim)))
    start = np.repeat(grid.window_lower, N, axis=0)
    position = grid.lower + h * (start + (cells + within).reshape(2 * N, dim))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    f = np.stack([deformation(rng, dim) for _ in position])
    edge = draw(st.sampled_from([0.5, 0.8, 1.0 / 3.0, 0.05])) * h
    return grid, make_particles(position, [0, N, 2 * N], deformation_gradient=f, volume=edge**dim)


def fill(name, layout):
    grid, particles = layout
    table = make_shape(name, particles, grid).interpolate(particles=particles, grid=grid)
    return Case(grid, particles, table)


def parallelepipeds(case):
    """Largest entry of R⁻¹ per cell, which roundoff of gradients scales with."""
    return 1.0 / min(
        1.0, 0.5 * case.particles.initial_volume[0] ** (1.0 / case.grid.dim) / case.grid.cell_size
    )


@EVERY_SHAPE
@DIMENSIONS
def test_consistency(name, dim):
    """Σ φ = 1, Σ φ x_i = x_p, Σ ∇φ = 0, Σ x_i ∇φᵀ = 1, φ ≥ 0."""

    @SETTINGS
    @given(layouts(dim))
    def check(layout):
        case = fill(name, layout)
        table, h = case.table, case.grid.cell_size
        x_p, x_i = case.particles.position / h, case.grid.position[table.nodes] / h
        gradient = table.gradient * h
        atol = 1e-12 * max(1.0, 0.1 * parallelepipeds(case))
        assert table.weight.min() >= -1e-15
        np.testing.assert_allclose(case.sum(table.weight), 1.0, atol=1e-12)
        np.testing.assert_allclose(case.sum(table.weight[:, None] * x_i), x_p, atol=1e-12)
        np.testing.assert_allclose(case.sum(gradient), 0.0, atol=atol)
        identity = case.sum(x_i[:, :, None] * gradient[:, None, :])
        np.testing.assert_allclose(identity, np.tile(np.eye(dim), (2 * N, 1, 1)), atol=10.0 * atol)

    check()


@EVERY_SHAPE
@DIMENSIONS
def test_nodes_stay_in_their_own_window(name, dim):
    @SETTINGS
    @given(layouts(dim))
    def check(layout):
        case = fill(name, layout)
        field = np.repeat([0] * N + [1] * N, np.diff(case.table.row))
        assert (case.table.nodes >= case.grid.offset[field]).all()
        assert (case.table.nodes < case.grid.offset[field + 1]).all()

    check()


def gradient_error(name, dim):
    """Largest difference of ∇φ from a central difference of φ, at points away from faces [1/cell]."""
    rng = np.random.default_rng(3)
    grid = make_test_grid([([0] * dim, [8] * dim)], cell_size=1.0, lower=np.zeros(dim))
    position = 3.0 + rng.uniform(
        0.26, 0.49, (20, dim)
    )  # no domain of half-length 0.25 ends within 0.01 of a face
    particles = make_particles(
        position, deformation_gradient=np.tile(np.eye(dim), (20, 1, 1)), volume=0.5**dim
    )
    if name == "cpdi":  # corners in different cells
        particles.position += 0.5
        particles.deformation_gradient[:, 0, 1] = 0.3
    shape, error, step = make_shape(name, particles, grid), 0.0, 1e-5
    table = shape.interpolate(particles=particles, grid=grid)
    exact, nodes = table.gradient.copy(), table.nodes.copy()
    for d in range(dim):
        weights = []
        for sign in (1.0, -1.0):
            particles.position[:, d] += sign * step
            moved = shape.interpolate(particles=particles, grid=grid)
            weights.append(moved.weight.copy())
            particles.position[:, d] -= sign * step
            assert (moved.nodes == nodes).all()
        error = max(error, np.abs((weights[0] - weights[1]) / (2.0 * step) - exact[:, d]).max())
    return error


@EVERY_SHAPE
@DIMENSIONS
def test_gradient_is_the_derivative(name, dim):
    error = gradient_error(name, dim)
    assert error > 1e-2 if name in EXCEPTIONS["derivative"] else error < 1e-9


@EVERY_SHAPE
@DIMENSIONS
def test_gradient_is_continuous_across_faces(name, dim):
    """Entries of points just below and above x = 4 are compared node by node."""
    grid = make_test_grid([([0] * dim, [9] * dim)], cell_size=1.0, lower=np.zeros(dim))
    position = np.full((2, dim), 4.3)
    position[:, 0] = 4.0 - 1e-9, 4.0 + 1e-9
    particles = make_particles(position, volume=0.5**dim)
    table = make_shape(name, particles, grid).interpolate(particles=particles, grid=grid)
    gradient = np.zeros((2, len(grid.position), dim))
    np.add.at(gradient, (np.repeat([0, 1], np.diff(table.row)), table.nodes), table.gradient)
    jump = np.abs(gradient[0] - gradient[1]).max()
    assert jump > 0.1 if name in EXCEPTIONS["smooth"] else jump < 1e-7
