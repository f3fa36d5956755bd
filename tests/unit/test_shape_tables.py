"""Tables of the shape functions against their published formulas, entry by entry, and at the grid's end."""

import numpy as np
import numpy_twins as twin
import pytest
from scipy.spatial.transform import Rotation

import mpmfw
from mpmfw.api import SceneError
from mpmfw.kernels import particle_grid, products
from mpmfw_shape.cubic_bspline import CubicBSpline
from mpmfw_testing import subject_of
from mpmfw_testing.shape import boxes, dense, place
from scenes_for_tests import SOFT, block
from support import SHAPES, make_particles, make_shape, make_test_grid

H = 0.25
CELLS = 10
DIMENSIONS = pytest.mark.parametrize("dim", [2, 3], ids=["2D", "3D"])
EVERY_SHAPE = pytest.mark.parametrize("name", SHAPES)


def make_problem(dim, *, n=40, seed=0):
    """Points of two velocity fields, each in a window of its own, deformed at random."""
    rng = np.random.default_rng(seed)
    first, shape = np.array([[0, 1, 2], [3, 2, 0]])[:, :dim], np.array([[8, 9, 7], [9, 7, 8]])[:, :dim]
    windows = list(zip(first.tolist(), shape.tolist(), strict=True))
    grid = make_test_grid(windows, cell_size=H, lower=-np.ones(dim))
    field = np.repeat([0, 1], n // 2)
    position = grid.lower + H * (first[field] + 2.0 + rng.random((n, dim)) * (shape[field] - 5.0))
    f = np.eye(dim) + rng.uniform(-0.2, 0.2, (n, dim, dim))
    points = make_particles(position, [0, n // 2, n], deformation_gradient=f, volume=(0.6 * H) ** dim)
    return grid, points


def expected_table(name, grid, particles, field):
    """Twin's values and gradients of all nodes of one velocity field."""
    nodes, x, h = grid.position[grid.field_nodes(field)], particles.position, grid.cell_size
    half = 0.5 * particles.initial_volume[0] ** (1.0 / particles.dim)
    if name == "cpdi":
        edges = np.tile(half * np.eye(particles.dim), (particles.count, 1, 1))
        return twin.dense_cpdi(x, particles.deformation_gradient, edges, nodes, h)
    bases = {"linear": twin.hat, "bspline": twin.quadratic, "cubic_bspline": twin.cubic, "ck": twin.compact}
    basis = bases.get(name, lambda t: twin.gimp(t, half / h))
    value, gradient = twin.dense_product(basis, x, nodes, h)
    if name == "ck":  # the mean of two grids: nodes whose indices are all even, or all odd
        index = np.round((nodes - grid.lower) / h).astype(int) % 2
        own = 0.5 * (index == index[:, :1]).all(axis=1)
        value, gradient = own * value, own[:, None] * gradient
    return value, gradient


def check_table(name, grid, particles):
    """Compare with the twin's sum over every node; return the table."""
    table = make_shape(name, particles, grid).interpolate(particles=particles, grid=grid)
    value, gradient = twin.dense(table, len(grid.position))
    for field in range(2):
        own, nodes = slice(particles.first[field], particles.first[field + 1]), grid.field_nodes(field)
        n, dn = expected_table(name, grid, particles, field)
        np.testing.assert_allclose(value[own, nodes], n[own], atol=1e-12)
        np.testing.assert_allclose(gradient[own, nodes], dn[own], atol=1e-12 / H)
        assert not value[own, grid.field_nodes(1 - field)].any()
    return table


@DIMENSIONS
@EVERY_SHAPE
def test_table_equals_the_formula(name, dim):
    check_table(name, *make_problem(dim))


@DIMENSIONS
@pytest.mark.parametrize("name", ["bspline", "gimp"])
def test_affine_field_of_products_is_that_of_their_table(name, dim):
    """B D⁻¹ with D = Σ φ q qᵀ, which is diagonal."""
    grid, particles = make_problem(dim)
    table = make_shape(name, particles, grid).interpolate(particles=particles, grid=grid)
    grid.velocity = grid.start_velocity = np.random.default_rng(1).normal(size=grid.position.shape)
    fields, place = np.zeros((2, particles.count, dim, dim)), particles.position.copy()
    for kernels, of, field in ((products, table.factors, fields[0]), (particle_grid, table, fields[1])):
        particles.position[:] = place
        kernels.gather(particles, field, particles.velocity_gradient, of, grid, 0.0, 0.0, 0.1, grid.spacing)
    np.testing.assert_allclose(*fields, rtol=1e-10, atol=1e-10 / H)


def test_a_table_of_products_is_that_of_the_points_when_it_is_read():
    grid, particles = make_problem(2)
    shape = make_shape("bspline", particles, grid)
    table = shape.interpolate(particles=particles, grid=grid)
    first = table.weight.copy()
    assert (np.diff(table.row) == products.WIDTH**2).all()
    particles.position += 0.1 * H
    np.testing.assert_array_equal(table.weight, first)
    assert shape.interpolate(particles=particles, grid=grid) is table
    assert np.abs(table.weight - first).max() > 0.01


@DIMENSIONS
@pytest.mark.parametrize("within", [0.25, 0.75], ids=["from a grid line", "to a grid line"])
def test_corners_on_grid_lines_keep_their_weight_there(dim, within):
    grid, particles = make_problem(dim)
    particles.initial_volume[:] = particles.volume[:] = (0.5 * H) ** dim
    particles.deformation_gradient[:] = np.eye(dim)
    particles.position[:] = grid.lower + H * (np.floor((particles.position - grid.lower) / H) + within)
    assert (np.diff(check_table("cpdi", grid, particles).row) == 2**dim).all()


def table_at(position):
    """φ and h ∇φ of cubic splines, of one point at ``position`` [cells] on the whole grid."""
    placed = place(subject_of(CubicBSpline, "shape", {}), [boxes(np.atleast_2d(position), 0.5)], CELLS)
    return dense(placed.table(), 0, placed.grid)


@pytest.mark.parametrize("xi", [0.0, 0.1, 0.5, 0.9, 1.0 - 1e-12])
def test_in_the_grids_first_cell_cubic_splines_are_the_modified_ones(xi):
    """Steffen's splines of the first four nodes; the last cell is the mirror image of the first."""
    (weight, gradient), (last, reverse) = table_at([xi, 5.3]), table_at([CELLS - xi, 5.3])
    middle, _ = twin.cubic(5.3 - np.arange(CELLS + 1))
    spline = np.array([xi**3 / 6.0 - xi + 1.0, -(xi**3) / 3.0 + xi, xi**3 / 6.0, 0.0])
    slope = np.array([0.5 * xi**2 - 1.0, 1.0 - xi**2, 0.5 * xi**2, 0.0])
    np.testing.assert_allclose(weight[:4], np.outer(spline, middle), atol=1e-14)
    np.testing.assert_allclose(gradient[:4, :, 0], np.outer(slope, middle), atol=1e-14)
    assert not weight[4:].any()
    np.testing.assert_allclose(last, weight[::-1], atol=1e-14)
    np.testing.assert_allclose(reverse[..., 0], -gradient[::-1, :, 0], atol=1e-14)


@pytest.mark.parametrize("where", ["modified", "refuse"])
def test_a_body_in_the_grids_last_cell(where):
    """A square at the grid's first corner flies inwards; unless the end is modified, it is refused."""
    scene = block(
        grid__lower=[-0.5, -0.5],
        bodies__solid__velocity=[1.0, 1.0],
        shape={"method": "cubic_bspline", "cubic_bspline": {"grid_end": where}},
    )
    if where == "refuse":
        with pytest.raises(SceneError, match="reaches beyond the grid"):
            mpmfw.run(scene)
        return
    centre = mpmfw.run(scene)["series/centre_of_mass"].values[:, 0]
    np.testing.assert_allclose(centre[-1] - centre[0], 0.05, rtol=1e-9)


@pytest.mark.parametrize("lower", [-0.6, -0.53], ids=["odd", "between"])
def test_sides_hold_a_block_of_compact_kernels_wherever_the_grids_lie(lower):
    """Driven down by a tenth between smooth walls: mean σ_yy of uniaxial strain; without, a tenth of it."""
    smooth = [{"side": "bottom", "fixed": ["y"]}, *({"side": x, "fixed": ["x"]} for x in ("left", "right"))]
    bulk, shear = 12e6, 6e6
    scene = block(
        grid={"cell_size": 0.1, "lower": [lower] * 2, "upper": [lower + 2.1] * 2},
        time={"end": 0.3535534, "output_interval": 0.3535534},
        shape__method="ck",
        materials__soft={**SOFT, "bulk_modulus": bulk, "shear_modulus": shear},
        bodies__solid__geometry={"type": "rectangle", "lower": [0.0, 0.0], "upper": [1.0, 1.0]},
        bodies__solid__particles={"layout": "fitted", "size": "0.5 cells"},
        bodies__solid__sides=[*smooth, {"side": "top", "velocity": ["free", -0.28284271]}],
    )
    stress = mpmfw.run(scene)["particles/solid/stress"].values[-1, :, 1, 1]
    j = 0.9
    exact = 0.5 * bulk * (j - 1.0 / j) + shear * j ** (-5.0 / 3.0) * (j * j - (2.0 + j * j) / 3.0)
    assert stress.mean() / exact == pytest.approx(1.0, abs=0.02)
    assert np.abs(stress / exact - 1.0).max() < 0.25


CELL, HALF = 0.1, 0.025


def table(f, at):
    """The functions of one point with the deformation gradient ``f``, nodes' positions and its reach."""
    dim = len(at)
    grid = make_test_grid([([0] * dim, [25] * dim)], cell_size=CELL, lower=np.zeros(dim))
    particles = make_particles(at[None], deformation_gradient=f[None].copy(), volume=(2.0 * HALF) ** dim)
    shape = make_shape("cpdi", particles, grid)
    phi = shape.interpolate(particles=particles, grid=grid)
    return phi, grid.position[phi.nodes], shape.particle_reach(particles=particles)[0]


def drawn_out(dim, stretch, shear, seed):
    """F of unit determinant: sheared, drawn out, and turned at random."""
    f = np.eye(dim)
    f[0, 1] = shear
    f = np.diag([stretch, *[stretch ** (-1.0 / (dim - 1))] * (dim - 1)]) @ f
    if dim == 3:
        return np.asarray(Rotation.random(random_state=seed).as_matrix() @ f)
    angle = 0.7 * seed
    return np.asarray([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]] @ f)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize(("stretch", "shear"), [(1.0, 3.0), (5.4, 4.0), (22.0, 0.0), (22.0, 5.0)])
def test_sums_are_exact_and_gradients_bounded(dim, stretch, shear):
    random = np.random.default_rng(1)
    for seed in range(20):
        at = 12 * CELL + CELL * random.random(dim)
        phi, node, reach = table(drawn_out(dim, stretch, shear, seed), at)
        assert phi.weight.sum() == pytest.approx(1.0, abs=1e-12)
        np.testing.assert_allclose(phi.weight @ (node - at), 0.0, atol=1e-12)
        np.testing.assert_allclose(phi.gradient.sum(axis=0), 0.0, atol=1e-9)
        np.testing.assert_allclose(phi.gradient.T @ (node - at), np.eye(dim), atol=1e-9)
        assert np.linalg.norm(phi.gradient, axis=1).max() <= np.sqrt(dim) / CELL
        assert np.abs(reach).max() <= 2.0 * HALF * np.sqrt(dim) * (1.0 + 1e-12)


def test_the_rectangle_does_not_depend_on_how_the_scene_is_turned():
    f, at = drawn_out(2, 5.0, 3.0, 0), np.array([1.23, 1.27])
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    centre = np.array([1.2, 1.2])
    phi, node, _ = table(f, at)
    turned, turned_node, _ = table(quarter @ f, centre + quarter @ (at - centre))
    expected = {
        tuple(np.round((centre + quarter @ (x - centre)) / CELL)): w
        for x, w in zip(node, phi.weight, strict=True)
    }
    for x, w in zip(turned_node, turned.weight, strict=True):
        assert w == pytest.approx(expected.get(tuple(np.round(x / CELL)), 0.0), abs=1e-12)
