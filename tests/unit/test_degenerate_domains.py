"""Degenerate CPDI domains: rectangles that keep the sums of the shape functions and bound their gradients."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from support import make_particles, make_shape, make_test_grid

H, HALF = 0.1, 0.025


def table(f, at):
    """The functions of one point with the deformation gradient ``f``, nodes' positions and its reach."""
    dim = len(at)
    grid = make_test_grid([([0] * dim, [25] * dim)], cell_size=H, lower=np.zeros(dim))
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
        at = 12 * H + H * random.random(dim)
        phi, node, reach = table(drawn_out(dim, stretch, shear, seed), at)
        assert phi.weight.sum() == pytest.approx(1.0, abs=1e-12)
        np.testing.assert_allclose(phi.weight @ (node - at), 0.0, atol=1e-12)
        np.testing.assert_allclose(phi.gradient.sum(axis=0), 0.0, atol=1e-9)
        np.testing.assert_allclose(phi.gradient.T @ (node - at), np.eye(dim), atol=1e-9)
        assert np.linalg.norm(phi.gradient, axis=1).max() <= np.sqrt(dim) / H
        assert np.abs(reach).max() <= 2.0 * HALF * np.sqrt(dim) * (1.0 + 1e-12)


def test_the_rectangle_does_not_depend_on_how_the_scene_is_turned():
    f, at = drawn_out(2, 5.0, 3.0, 0), np.array([1.23, 1.27])
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    centre = np.array([1.2, 1.2])
    phi, node, _ = table(f, at)
    turned, turned_node, _ = table(quarter @ f, centre + quarter @ (at - centre))
    expected = {
        tuple(np.round((centre + quarter @ (x - centre)) / H)): w
        for x, w in zip(node, phi.weight, strict=True)
    }
    for x, w in zip(turned_node, turned.weight, strict=True):
        assert w == pytest.approx(expected.get(tuple(np.round(x / H)), 0.0), abs=1e-12)
