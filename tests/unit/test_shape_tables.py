"""Tables of the shape functions against their published formulas, entry by entry, and what the fill kernels
refuse."""

from __future__ import annotations

import numpy as np
import numpy_twins as twin
import pytest

from mpmfw.api import OutsideGrid, Stencil
from mpmfw.step.schemes import add_internal_force, project
from support import SHAPES, make_particles, make_shape, make_test_grid

H = 0.25
DIMENSIONS = pytest.mark.parametrize("dim", [2, 3], ids=["2D", "3D"])


def make_problem(dim, *, n=40, seed=0):
    """Points of two velocity fields, each in a window of its own, deformed at random."""
    rng = np.random.default_rng(seed)
    first, shape = np.array([[0, 1, 2], [3, 2, 0]])[:, :dim], np.array([[8, 9, 7], [9, 7, 8]])[:, :dim]
    grid = make_test_grid(
        list(zip(first.tolist(), shape.tolist(), strict=True)), cell_size=H, lower=-np.ones(dim)
    )
    field = np.repeat([0, 1], n // 2)
    position = grid.lower + H * (first[field] + 2.0 + rng.random((n, dim)) * (shape[field] - 5.0))
    deformation = np.eye(dim) + rng.uniform(-0.2, 0.2, (n, dim, dim))
    particles = make_particles(
        position, [0, n // 2, n], deformation_gradient=deformation, volume=(0.6 * H) ** dim
    )
    return grid, particles


def expected_table(name, grid, particles, field):
    """Twin's values and gradients of all nodes of one velocity field."""
    nodes, x, h = grid.position[grid.field_nodes(field)], particles.position, grid.cell_size
    half = 0.5 * particles.initial_volume[0] ** (1.0 / particles.dim)
    if name == "cpdi":
        edges = np.tile(half * np.eye(particles.dim), (particles.count, 1, 1))
        return twin.dense_cpdi(x, particles.deformation_gradient, edges, nodes, h)
    basis = {"linear": twin.hat, "bspline": twin.quadratic, "gimp": lambda t: twin.gimp(t, half / h)}[name]
    return twin.dense_product(basis, x, nodes, h)


@DIMENSIONS
@pytest.mark.parametrize("name", SHAPES)
def test_table_equals_the_formula(name, dim):
    grid, particles = make_problem(dim)
    table = make_shape(name, particles, grid).interpolate(particles=particles, grid=grid)
    value, gradient = twin.dense(table, len(grid.position))
    for field in range(2):
        own = slice(particles.first[field], particles.first[field + 1])
        nodes = grid.field_nodes(field)
        n, dn = expected_table(name, grid, particles, field)
        np.testing.assert_allclose(value[own, nodes], n[own], atol=1e-12)
        np.testing.assert_allclose(gradient[own, nodes], dn[own], atol=1e-12 / H)
        assert not value[own, grid.field_nodes(1 - field)].any()


def check_cpdi(grid, particles):
    """Compare with the twin's sum over every corner; return the table."""
    table = make_shape("cpdi", particles, grid).interpolate(particles=particles, grid=grid)
    value, gradient = twin.dense(table, len(grid.position))
    for field in range(2):
        own, nodes = slice(particles.first[field], particles.first[field + 1]), grid.field_nodes(field)
        n, dn = expected_table("cpdi", grid, particles, field)
        np.testing.assert_allclose(value[own, nodes], n[own], atol=1e-12)
        np.testing.assert_allclose(gradient[own, nodes], dn[own], atol=1e-12 / H)
    return table


@DIMENSIONS
def test_corners_on_grid_lines_keep_their_weight_there(dim):
    grid, particles = make_problem(dim)
    particles.initial_volume[:] = particles.volume[:] = (0.5 * H) ** dim
    particles.deformation_gradient[:] = np.eye(dim)
    cells = np.floor((particles.position - grid.lower) / H)
    particles.position[:] = grid.lower + H * (
        cells + 0.25
    )  # every domain reaches from a grid line to mid-cell
    table = check_cpdi(grid, particles)
    assert (np.diff(table.row) == 2**dim).all()
    particles.position[:] = grid.lower + H * (cells + 0.75)  # from mid-cell to the next line
    table = check_cpdi(grid, particles)
    assert (np.diff(table.row) == 2**dim).all()


@DIMENSIONS
@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("index", [0, 13, 39])
@pytest.mark.parametrize("value", [np.nan, np.inf, 1e30, 2.0])
def test_first_point_outside_its_window_is_reported(name, dim, index, value):
    grid, particles = make_problem(dim)
    shape = make_shape(name, particles, grid)
    particles.position[index:, dim - 1] = value
    with pytest.raises(OutsideGrid) as error:
        shape.interpolate(particles=particles, grid=grid)
    assert error.value.index == index


@DIMENSIONS
@pytest.mark.parametrize("name", SHAPES)
def test_point_outside_its_own_window_but_inside_the_other(name, dim):
    grid, particles = make_problem(dim)
    shape = make_shape(name, particles, grid)
    particles.position[5] = grid.position[grid.field_nodes(1)].max(axis=0) - 2.0 * H
    with pytest.raises(OutsideGrid) as error:
        shape.interpolate(particles=particles, grid=grid)
    assert error.value.index == 5


def with_the_zeros(table, grid, particles):
    """The same with every row of 3**dim entries, in the order of the nodes: what the leaner rows leave out is
    zero.
    """
    dim, nodes, weight, gradient = particles.dim, [], [], []
    for p in range(particles.count):
        own, field = slice(table.row[p], table.row[p + 1]), int(p >= particles.first[1])
        shape, first = grid.window_shape[field], grid.offset[field]
        base = np.stack(np.unravel_index(table.nodes[own] - first, shape)).min(axis=1)
        box = [np.arange(base[d], base[d] + 3) for d in range(dim)]
        row = first + np.ravel_multi_index(np.meshgrid(*box, indexing="ij"), shape).ravel()
        place = np.searchsorted(row, table.nodes[own])
        np.testing.assert_array_equal(row[place], table.nodes[own])
        n, dn = np.zeros(3**dim), np.zeros((3**dim, dim))
        n[place], dn[place] = table.weight[own], table.gradient[own]
        nodes, weight, gradient = [*nodes, row], [*weight, n], [*gradient, dn]
    row = 3**dim * np.arange(particles.count + 1)
    return Stencil(
        row, np.concatenate(nodes).astype(np.int32), np.concatenate(weight), np.concatenate(gradient)
    )


@DIMENSIONS
def test_gimp_leaves_out_what_is_zero_and_nothing_changes(dim):
    grid, particles = make_problem(dim, n=400)
    rng = np.random.default_rng(3)
    particles.velocity[:] = rng.standard_normal(particles.velocity.shape)
    particles.stress[:] = rng.standard_normal(particles.stress.shape)
    particles.mass[:] = rng.random(particles.count)
    table = make_shape("gimp", particles, grid).interpolate(particles=particles, grid=grid)
    length = np.diff(table.row)
    assert set(length.tolist()) == {2 ** (dim - k) * 3**k for k in range(dim + 1)}
    assert (np.abs(table.gradient).sum(axis=1) > 0.0).all()
    full = with_the_zeros(table, grid, particles)
    results = []
    for phi in (table, full):
        grid.mass = np.zeros(len(grid.position))
        grid.momentum, grid.start_velocity, grid.force = (np.zeros_like(grid.position) for _ in range(3))
        project(particles, phi, grid)
        add_internal_force(particles, phi, grid)
        results.append([grid.mass, grid.momentum, grid.force])
    for lean, padded in zip(*results, strict=True):
        np.testing.assert_array_equal(lean, padded)
