"""Each kernel against its NumPy twin, on random data in two and three dimensions."""

from types import SimpleNamespace

import numpy as np
import numpy_twins as twin
import pytest

from mpmfw.api import Stencil
from mpmfw.kernels import kernel, particle_grid, struct
from mpmfw.kernels.stencil import WIDEST, fill_tensor_product
from mpmfw.step.transfer import make_transfer
from support import as_grid, as_points

N_POINTS, N_NODES = 23, 41


def close(actual, expected):
    """Agreement to 1e-12 of the largest component."""
    np.testing.assert_allclose(actual, expected, rtol=1e-12, atol=1e-12 * max(1.0, np.abs(expected).max()))


@pytest.fixture(params=[(2, 0), (3, 0), (2, 4), (3, 8)], ids=["2D", "3D", "2D, all of 4", "3D, all of 8"])
def problem(request):
    """Random fields and a table with rows of one length, or of different ones of which one is empty."""
    dim, width = request.param
    rng = np.random.default_rng(dim)
    lengths = np.full(N_POINTS, width) if width else rng.integers(4, 12, N_POINTS)
    lengths[3] = width
    row = np.concatenate([[0], np.cumsum(lengths)])
    table = Stencil(
        row,
        rng.integers(0, N_NODES, row[-1]).astype(np.int32),
        rng.random(row[-1]),
        rng.normal(size=(row[-1], dim)),
        width,
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
    particle_grid.gather(p, filled_in, p.velocity_gradient, t, g, factor, flip, dt, x.spacing)
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


def test_gather_leaves_out_what_a_second_projection_gives(problem):
    x, p, g = problem, problem.points, problem.grid
    rate = p.velocity_gradient.copy()
    particle_grid.gather(p, None, None, x.table, g, 0.0, 1.0, 0.01, x.spacing)
    np.testing.assert_array_equal(p.velocity_gradient, rate)
    particle_grid.gather(p, None, x.affine, x.table, g, 0.0, 1.0, 0.01, x.spacing)
    close(x.affine, twin.velocity_gradient(x.table, g.velocity))


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
