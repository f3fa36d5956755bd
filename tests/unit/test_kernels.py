"""Each kernel against its NumPy twin, on random data in two and three dimensions."""

from types import SimpleNamespace

import numpy as np
import numpy_twins as twin
import pytest

from mpmfw.api import Stencil
from mpmfw.kernels import arithmetic, kernel, particle_grid, struct
from mpmfw.kernels.stencil import WIDEST, fill_tensor_product
from mpmfw.step.transfer import make_transfer
from support import as_grid, as_points

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
    points = as_points(
        mass=rng.random(N_POINTS) + 0.5,
        volume=rng.random(N_POINTS) + 0.5,
        initial_volume=rng.random(N_POINTS) + 0.5,
        velocity=rng.normal(size=(N_POINTS, dim)),
        position=rng.normal(size=(N_POINTS, dim)),
        stress=rng.normal(size=tensor),
        velocity_gradient=rng.normal(size=tensor),
        deformation_gradient=np.eye(dim) + 0.2 * rng.normal(size=tensor),
    )
    grid = as_grid(
        position=rng.normal(size=(N_NODES, dim)),
        velocity=rng.normal(size=(N_NODES, dim)),
        start_velocity=rng.normal(size=(N_NODES, dim)),
        mass=np.where(rng.random(N_NODES) < 0.2, 0.0, rng.random(N_NODES)),
        momentum=np.ones((N_NODES, dim)),
        force=np.ones((N_NODES, dim)),
    )
    affine = rng.normal(size=tensor)
    return SimpleNamespace(
        dim=dim, spacing=(0.5,) * dim, table=table, points=points, grid=grid, affine=affine
    )


@pytest.mark.parametrize("thick", [False, True])
@pytest.mark.parametrize("with_affine", [False, True])
def test_internal_force(problem, thick, with_affine):
    """Alone, and in one pass with the projection, which is the same to the bit."""
    x, t, p, g = problem, problem.table, problem.points, problem.grid
    thickness = np.linspace(1.0, 2.0, N_POINTS) if thick else None
    affine = x.affine if with_affine else None
    g.mass = np.ones(N_NODES)
    particle_grid.add_internal_force(p, thickness, t, g, x.spacing)
    volume = p.volume * thickness if thick else p.volume
    close(g.force, 1.0 + twin.internal_force(t, volume, p.stress, N_NODES))
    particle_grid.project(p, p.position, affine, t, g, g.mass, x.spacing)
    apart = [array.copy() for array in (g.mass, g.momentum, g.force)]
    g.mass, g.momentum, g.force = (np.ones_like(array) for array in apart)
    particle_grid.project_with_force(p, affine, thickness, t, g, x.spacing)
    for array, alone in zip((g.mass, g.momentum, g.force), apart, strict=True):
        np.testing.assert_array_equal(array, alone)


def test_affine_from_moment(problem):
    x, t, p, g = problem, problem.table, problem.points, problem.grid
    affine = np.zeros_like(x.affine)
    particle_grid.affine_from_moment(p, p.position, p.stress, affine, t, g, x.spacing)
    tiny = 1e-10 * x.spacing[0] ** 2 * np.eye(x.dim)
    spread = twin.spread(t, p.position, g.position) + tiny
    filled = np.diff(t.row) > 0
    close(affine[filled], (p.stress @ np.linalg.inv(spread))[filled])


@pytest.mark.parametrize("flip", [1.0, 0.0, 0.7])
@pytest.mark.parametrize("affine", ["none", "moment", "known", "least_squares"])
def test_gather(problem, flip, affine):
    x, t, dt, p, g = problem, problem.table, 0.01, problem.points, problem.grid
    velocity, position, field = p.velocity.copy(), p.position.copy(), np.zeros_like(x.affine)
    filled_in = None if affine == "none" else field
    factor = {"moment": 1.0, "known": 4.0}.get(affine, 0.0)
    particle_grid.gather(p, filled_in, t, g, factor, flip, dt, x.spacing)
    new = twin.collect(t, t.weight[:, None] * g.velocity[t.nodes])
    start = twin.collect(t, t.weight[:, None] * g.start_velocity[t.nodes])
    close(p.velocity, flip * (velocity + new - start) + (1.0 - flip) * new)
    close(p.position, position + dt * new)
    close(p.velocity_gradient, twin.velocity_gradient(t, g.velocity))
    moment = twin.moment(t, position, g.position, g.velocity)
    filled = np.diff(t.row) > 0
    if affine == "least_squares":
        spread = twin.spread(t, position, g.position)
        close(field[filled], moment[filled] @ np.linalg.inv(spread[filled]))
    else:
        close(field, factor * moment)


def test_a_singular_spread_takes_the_gradient_and_pic_fraction_blends():
    """A stored moment needs the inverse at its next use only, where it is regularised."""
    for name, transported, affine in (
        *(("aflip", None, "gradient"), ("apic", True, "gradient"), ("apic", None, "moment")),
    ):
        given = {} if transported is None else {"transported": transported}
        assert make_transfer(name, singular_spread=True, **given).affine == affine
    assert make_transfer("aflip", singular_spread=False).affine == "least_squares"
    assert make_transfer("aflip", singular_spread=False, spread=0.5).inverse_spread == 2.0
    assert make_transfer("flip", singular_spread=False, pic_fraction=0.25).flip == 0.75


@kernel
def in_one_operation(a, b, factor, at, product, quotient, hats, matrices, spacing):
    """What acts on a whole matrix or on all corners."""
    arithmetic.copy_matrix(matrices, 1, matrices, 2, spacing)
    arithmetic.add_outer_product(product, a, 2, b, 1, spacing)
    arithmetic.divide(quotient, a[0, 0], spacing)
    for d in range(len(spacing)):
        arithmetic.multiply_by_hats(hats[d], factor, at, d, 3, spacing)


@pytest.mark.parametrize("dim", [2, 3])
def test_what_acts_in_one_operation_is_rounded_as_number_by_number(dim):
    """Of a sum of products each product may be added without being rounded first."""
    rng, corners = np.random.default_rng(dim), 2**dim
    a, b, factor = rng.normal(size=(4, dim)), rng.normal(size=(4, dim)), rng.normal(size=8)
    product, quotient = rng.normal(size=(2, dim, dim))
    at = 3.0 + rng.normal(size=(dim, 8))
    at[0, 0] = np.nan
    wanted, divided = product + np.outer(a[2], b[1]), quotient / a[0, 0]
    hats, expected = np.full((dim, 8), -1.0), np.full((dim, 8), -1.0)
    expected[:, :corners] = (factor * np.maximum(1.0 - np.abs(at - 3.0), 0.0))[:, :corners]
    matrices = rng.normal(size=(4, dim, dim))
    copied = matrices[[0, 2, 2, 3]]
    in_one_operation(a, b, factor, at, product, quotient, hats, matrices, (0.5,) * dim)
    np.testing.assert_allclose(product, wanted, rtol=0.0, atol=2.0**-52 * np.abs(wanted).max())
    np.testing.assert_array_equal(matrices, copied)
    np.testing.assert_array_equal(quotient, divided)
    np.testing.assert_array_equal(hats, expected)


@kernel
def fill_widest(base, weight, slope, shape, table, spacing):
    fill_tensor_product(0, WIDEST, base, weight, slope, shape, 0, table, spacing)


def test_rows_of_tensor_products_may_be_as_wide_as_stencil_says():
    weight, slope = np.random.default_rng(0).normal(size=(2, 2, WIDEST))
    table, n = struct(**{name: np.zeros(1) for name in ("row", "nodes", "weight", "gradient")}), WIDEST**2
    table.set(nodes=np.zeros(n, np.int32), weight=np.zeros(n), gradient=np.zeros((n, 2)))
    fill_widest(np.zeros(2), weight, slope, np.array([WIDEST, WIDEST]), table, (0.5, 0.5))
    np.testing.assert_array_equal(table.nodes, np.arange(n))
    np.testing.assert_array_equal(table.weight, np.outer(*weight).ravel())
    np.testing.assert_array_equal(table.gradient[:, 1], np.outer(weight[0], slope[1]).ravel())
