"""Numbers in lanes give what floats give, to the bit, and whatever number of points there is."""

import math

import numpy as np
import pytest

from mpmfw.kernels import kernel, lanes, motion
from mpmfw_material.neo_hookean import SMALL, inverse_five_thirds, neo_hookean_split
from support import as_points


@kernel
def copy(a, out, spacing):
    """From points to lanes and back."""
    x = lanes.matrix(spacing, spacing)
    for p in range(0, len(a), lanes.WIDTH):
        lanes.read(a, lanes.points_from(p, len(a)), x, spacing)
        lanes.write(out, lanes.points_from(p, len(a)), x, spacing)


@pytest.mark.parametrize("dim", [2, 3])
def test_stress_does_not_depend_on_the_points_beside(dim):
    """Small and large changes of volume in one vector, on both sides of where the series end."""
    spacing = (1.0,) * dim
    jacobian = np.array([0.3, 1.0, 1.0 - SMALL, 1.0 - 0.999 * SMALL, 1.0 + 0.999 * SMALL, 1.0 + SMALL, 2.0])
    f = np.eye(dim) * jacobian[:, None, None] ** (1.0 / dim)
    together, alone = np.zeros_like(f), np.zeros_like(f)
    neo_hookean_split(0, len(f), f, together, 2.0, 1.0, spacing)
    for p in range(len(f)):
        neo_hookean_split(p, p + 1, f, alone, 2.0, 1.0, spacing)
    np.testing.assert_array_equal(together, alone)
    b = jacobian ** (2.0 / dim)
    pressure = jacobian - 1.0 / jacobian - jacobian ** (-5.0 / 3.0) * (dim * b + 3 - dim) / 3.0
    expected = np.eye(dim) * (pressure + jacobian ** (-5.0 / 3.0) * b)[:, None, None]
    np.testing.assert_allclose(together, expected, rtol=1e-13, atol=1e-15)


def test_the_series_are_exact_to_rounding_where_they_are_used():
    for jacobian in np.linspace(1.0 - SMALL, 1.0 + SMALL, 101):
        assert math.isclose(inverse_five_thirds(jacobian), jacobian ** (-5.0 / 3.0), rel_tol=5e-16)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("count", [1, 4, 6])
def test_deformation_and_affine_transport(dim, count):
    rng, spacing, dt = np.random.default_rng(count), (1.0,) * dim, 0.1
    arrays = {name: np.eye(dim) + 0.2 * rng.random((count, dim, dim)) for name in "FL"}
    initial, affine = 1.0 + rng.random(count), rng.random((count, dim, dim))
    points = as_points(
        mass=np.ones(count),
        initial_volume=initial,
        volume=np.zeros(count),
        deformation_gradient=arrays["F"].copy(),
        velocity_gradient=arrays["L"],
    )
    expected = (np.eye(dim) + dt * arrays["L"]) @ arrays["F"]
    assert motion.update_deformation(points, dt, spacing) == -1
    np.testing.assert_allclose(points.deformation_gradient, expected, rtol=1e-14)
    np.testing.assert_allclose(points.volume, np.linalg.det(expected) * initial, rtol=1e-13)
    carried = affine @ np.linalg.inv(np.eye(dim) + dt * affine)
    motion.transport_affine(points, affine, dt, spacing)
    np.testing.assert_allclose(affine, carried, rtol=1e-12)
    for bad in range(count - 1, -1, -1):
        points.deformation_gradient[bad, 0] *= np.nan if bad % 2 else -1.0
        assert motion.update_deformation(points, 0.0, spacing) == bad
