"""Each kernel against its NumPy twin, on random data in two and three dimensions."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import numpy_twins as twin
import pytest

from mpmfw.api import Stencil
from mpmfw.kernels import gather, kernel, nodal, projection, rows, scratch
from mpmfw.kernels.small_matrix import determinant, invert

N_POINTS, N_NODES = 23, 41


def close(actual, expected):
    """Agreement to 1e-12 of the largest component."""
    np.testing.assert_allclose(actual, expected, rtol=1e-12, atol=1e-12 * max(1.0, np.abs(expected).max()))


@pytest.fixture(params=[2, 3], ids=["2D", "3D"])
def problem(request):
    """Random fields and a table with rows of different lengths, one of them empty."""
    dim = request.param
    rng = np.random.default_rng(dim)
    lengths = rng.integers(4, 12, N_POINTS)
    lengths[3] = 0
    row = np.concatenate([[0], np.cumsum(lengths)])
    table = Stencil(
        row,
        rng.integers(0, N_NODES, row[-1]).astype(np.int32),
        rng.random(row[-1]),
        rng.normal(size=(row[-1], dim)),
    )
    tensor = (N_POINTS, dim, dim)
    return SimpleNamespace(
        dim=dim,
        spacing=(0.5,) * dim,
        table=table,
        mass=rng.random(N_POINTS) + 0.5,
        volume=rng.random(N_POINTS) + 0.5,
        velocity=rng.normal(size=(N_POINTS, dim)),
        position=rng.normal(size=(N_POINTS, dim)),
        affine=rng.normal(size=tensor),
        stress=rng.normal(size=tensor),
        deformation=np.eye(dim) + 0.2 * rng.normal(size=tensor),
        node_position=rng.normal(size=(N_NODES, dim)),
        node_velocity=rng.normal(size=(N_NODES, dim)),
        start_velocity=rng.normal(size=(N_NODES, dim)),
        node_mass=np.where(rng.random(N_NODES) < 0.2, 0.0, rng.random(N_NODES)),
    )


@pytest.mark.parametrize("with_affine", [False, True])
def test_projection_adds_mass_and_momentum(problem, with_affine):
    x, t = problem, problem.table
    affine = x.affine if with_affine else None
    mass, momentum, again = np.ones(N_NODES), np.ones((N_NODES, x.dim)), np.ones((N_NODES, x.dim))
    points = (x.mass, x.velocity, x.position, affine, x.node_position)
    projection.project_mass_momentum(t.row, t.nodes, t.weight, *points, mass, momentum, x.spacing)
    projection.project_momentum(t.row, t.nodes, t.weight, *points, again, x.spacing)
    close(mass, 1.0 + twin.scatter(t, t.weight * x.mass[twin.owner(t)], N_NODES))
    close(momentum, 1.0 + twin.projected_momentum(t, *points))
    close(again, momentum)


def test_internal_force(problem):
    x, t = problem, problem.table
    force = np.ones((N_NODES, x.dim))
    projection.add_internal_force(t.row, t.nodes, t.gradient, x.volume, x.stress, force, x.spacing)
    close(force, 1.0 + twin.internal_force(t, x.volume, x.stress, N_NODES))


def test_affine_from_moment(problem):
    x, t = problem, problem.table
    affine = np.zeros_like(x.affine)
    projection.affine_from_moment(
        t.row, t.nodes, t.weight, x.position, x.stress, x.node_position, affine, x.spacing
    )
    tiny = 1e-10 * x.spacing[0] ** 2 * np.eye(x.dim)
    spread = twin.spread(t, x.position, x.node_position) + tiny
    filled = np.diff(t.row) > 0
    close(affine[filled], (x.stress @ np.linalg.inv(spread))[filled])


@pytest.mark.parametrize("flip", [1.0, 0.0, 0.7])
@pytest.mark.parametrize("affine", ["none", "moment", "least_squares"])
def test_gather(problem, flip, affine):
    x, t, dt = problem, problem.table, 0.01
    velocity, position = x.velocity.copy(), x.position.copy()
    gradient, field = np.zeros_like(x.affine), np.zeros_like(x.affine)
    gather.gather(
        t.row,
        t.nodes,
        t.weight,
        t.gradient,
        x.node_position,
        x.node_velocity,
        x.start_velocity,
        velocity,
        position,
        gradient,
        None if affine == "none" else field,
        affine == "least_squares",
        flip,
        dt,
        x.spacing,
    )
    new = twin.collect(t, t.weight[:, None] * x.node_velocity[t.nodes])
    start = twin.collect(t, t.weight[:, None] * x.start_velocity[t.nodes])
    close(velocity, flip * (x.velocity + new - start) + (1.0 - flip) * new)
    close(position, x.position + dt * new)
    close(gradient, twin.velocity_gradient(t, x.node_velocity))
    moment = twin.moment(t, x.position, x.node_position, x.node_velocity)
    filled = np.diff(t.row) > 0
    if affine == "least_squares":
        spread = twin.spread(t, x.position, x.node_position)
        close(field[filled], moment[filled] @ np.linalg.inv(spread[filled]))
    else:
        close(field, moment if affine == "moment" else 0.0 * moment)


def test_velocity_gradient_alone(problem):
    x, t = problem, problem.table
    gradient = np.ones_like(x.affine)
    gather.gather_velocity_gradient(t.row, t.nodes, t.gradient, x.node_velocity, gradient, x.spacing)
    close(gradient, twin.velocity_gradient(t, x.node_velocity))


def test_transport_of_the_affine_field(problem):
    x, dt = problem, 0.01
    affine = x.affine.copy()
    gather.transport_affine(affine, dt, x.spacing)
    close(affine, x.affine @ np.linalg.inv(np.eye(x.dim) + dt * x.affine))


def test_deformation_and_volume(problem):
    x, dt = problem, 0.01
    deformation, volume = x.deformation.copy(), np.zeros(N_POINTS)
    bad = gather.update_deformation(x.affine, deformation, x.volume, volume, dt, x.spacing)
    expected = (np.eye(x.dim) + dt * x.affine) @ x.deformation
    close(deformation, expected)
    close(volume, np.linalg.det(expected) * x.volume)
    assert bad == -1


@pytest.mark.parametrize("value", [np.nan, -1.0])
def test_first_inverted_point_is_reported(problem, value):
    deformation = np.tile(np.eye(problem.dim), (N_POINTS, 1, 1))
    deformation[[7, 11], 0, 0] = value
    rate = np.zeros_like(deformation)
    volume = np.zeros(N_POINTS)
    assert gather.update_deformation(rate, deformation, problem.volume, volume, 1.0, problem.spacing) == 7


def test_nodal_kernels(problem):
    x, dt = problem, 0.3
    momentum, velocity = x.node_velocity.copy(), np.ones((N_NODES, x.dim))
    has_mass = x.node_mass[:, None] > 0.0
    nodal.integrate_momentum(x.node_mass, momentum, x.start_velocity, dt, x.spacing)
    close(momentum, x.node_velocity + np.where(has_mass, dt * x.start_velocity, 0.0))
    nodal.velocity_of_momentum(x.node_mass, momentum, velocity, x.spacing)
    close(velocity, np.where(has_mass, momentum / np.where(has_mass, x.node_mass[:, None], 1.0), 0.0))
    force = x.start_velocity.copy()
    nodal.add_body_force(x.node_mass, np.arange(1.0, x.dim + 1.0), force, x.spacing)
    close(force, x.start_velocity + x.node_mass[:, None] * np.arange(1.0, x.dim + 1.0))


def test_results_are_bitwise_repeatable(problem):
    x, t = problem, problem.table
    runs = []
    for _ in range(2):
        force = np.zeros((N_NODES, x.dim))
        projection.add_internal_force(t.row, t.nodes, t.gradient, x.volume, x.stress, force, x.spacing)
        runs.append(force.tobytes())
    assert runs[0] == runs[1]


@kernel
def _determinant_and_inverse(matrices, inverses, determinants, spacing):
    for n in range(len(matrices)):
        determinants[n] = determinant(matrices[n], spacing)
        invert(matrices[n], inverses[n], spacing)


def test_small_matrices(problem):
    inverses, determinants = np.zeros_like(problem.deformation), np.zeros(N_POINTS)
    _determinant_and_inverse(problem.deformation, inverses, determinants, problem.spacing)
    close(determinants, np.linalg.det(problem.deformation))
    close(inverses, np.linalg.inv(problem.deformation))


def test_singular_matrix_gives_no_exception(problem):
    matrices = np.zeros((1, problem.dim, problem.dim))
    inverses, determinants = np.ones_like(matrices), np.ones(1)
    _determinant_and_inverse(matrices, inverses, determinants, problem.spacing)
    assert determinants[0] == 0.0
    assert not np.isfinite(inverses).any()


@kernel
def _through_scratch(values, out, spacing):
    """Copy through every kind of scratch array; arrays made in turn must not share memory."""
    dim = len(spacing)
    v = scratch.vector(spacing)
    m = scratch.matrix(spacing, (0.0, 0.0, 0.0, 0.0))
    n = scratch.integers(spacing)
    for i in range(len(values)):
        for d in range(dim):
            v[d] = values[i, d]
            n[d] = int(values[i, d])
            for a in range(4):
                m[d, a] = values[i, d] * a
        for d in range(dim):
            out[i, d] = v[d] + n[d]
            for a in range(4):
                out[i, d] += m[d, a]
    return v.shape, m.shape, n.shape


def test_scratch_arrays(problem):
    values = np.random.default_rng(0).uniform(-9.0, 9.0, (5, problem.dim))
    out = np.zeros_like(values)
    shapes = _through_scratch(values, out, problem.spacing)
    close(out, 7.0 * values + np.trunc(values))
    assert shapes == ((problem.dim,), (problem.dim, 4), (problem.dim,))


@kernel
def _row_operations(out, i, factor, other, j, spacing):
    rows.add_scaled_row(out, i[0], factor, other, j[0], spacing)
    rows.set_scaled_row(out, i[1], factor, other, j[1], spacing)


@pytest.mark.parametrize("index_type", [np.int64, np.int32, np.uint64])
def test_rows(problem, index_type):
    rng = np.random.default_rng(1)
    out, other = rng.normal(size=(6, problem.dim)), rng.normal(size=(4, problem.dim))
    expected = out.copy()
    expected[5] += 1.5 * other[3]
    expected[0] = 1.5 * other[0]
    _row_operations(
        out, np.array([5, 0], index_type), 1.5, other, np.array([3, 0], index_type), problem.spacing
    )
    np.testing.assert_array_equal(out, expected)


def test_rows_refuse_arrays_that_are_not_contiguous(problem):
    out, index = np.zeros((6, problem.dim)), np.array([0, 0])
    with pytest.raises(Exception, match="C-contiguous"):
        _row_operations(out, index, 1.0, np.zeros((4, 2 * problem.dim))[:, ::2], index, problem.spacing)
