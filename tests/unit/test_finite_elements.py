"""The finite-element program of validation/finite-elements: what its curves rest on."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "validation" / "finite-elements"))

from rings_fem import collide, distance
from rings_fem import verification as verify
from rings_fem.compiled import Floats
from rings_fem.contact import add_contact_force
from rings_fem.element import DENSITY, solid_of
from rings_fem.mesh import INNER, OUTER, block, ring


@pytest.mark.parametrize("gradient", verify.HOMOGENEOUS)
def test_a_homogeneous_deformation_is_exact_on_a_distorted_mesh(gradient):
    patch = verify.patch_test(np.array(gradient))
    assert patch.equilibrium < 1e-12
    assert patch.stress < 1e-12
    assert patch.traction < 1e-12
    assert patch.energy < 1e-12


@pytest.mark.parametrize("angle", [0.1, 1.0, np.pi])
def test_a_rigid_motion_gives_no_force(angle):
    assert verify.rotation_error(angle) < 1e-12


@pytest.mark.parametrize("seed", [2, 3])
def test_the_internal_force_is_the_gradient_of_the_strain_energy(seed):
    assert verify.internal_gradient_error(seed) < 1e-7


def test_the_contact_force_is_the_gradient_of_the_springs_energy():
    assert verify.contact_gradient_error() < 1e-7


def test_contact_leaves_neither_a_force_nor_a_moment():
    assert verify.contact_balance_error() < 1e-12


def test_contact_pushes_apart_and_never_pulls():
    points, left, right = verify.overlapping()
    force = np.zeros_like(points)
    assert add_contact_force(points, left, right, force) > 0.0
    assert force[left.nodes, 0].sum() < 0.0 < force[right.nodes, 0].sum()
    apart: Floats = points.copy()
    apart[right.nodes, 0] += 3.5e-3  # 3 mm overlap; corners of the coarse polygons lie inside the circles
    force[:] = 0.0
    assert add_contact_force(apart, left, right, force) == 0.0
    assert not force.any()


def test_a_mesh_has_the_mass_of_the_polygon_between_its_circles():
    around = 120
    area = 0.5 * around * np.sin(2.0 * np.pi / around) * (OUTER**2 - INNER**2)
    mesh = ring(2e-3, 0.3, 0.4)
    assert len(mesh.elements) == 5 * around
    assert solid_of(mesh).mass.sum() == pytest.approx(DENSITY * area)
    assert solid_of(block(3, 2)).weights.sum() == pytest.approx(1.0)


def test_a_ring_breathes_at_the_frequency_of_the_bessel_functions():
    coarse, fine = verify.breathing_error(5e-3), verify.breathing_error(2.5e-3)
    assert abs(coarse) < 2e-3
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.2)


def test_a_collision_keeps_energy_and_momentum():
    collision = collide(5e-3, times=(0.0, 0.4e-3))
    assert collision.impulse[-1] > 100.0
    assert collision.energy_error < 2e-3
    assert collision.momentum_error < 1e-12
    # impulse is what changes the momentum
    gained = collision.momentum_right - collision.momentum_right[0]
    np.testing.assert_allclose(gained, collision.impulse, atol=1e-10)


def test_fields_are_of_the_times_that_are_asked_for():
    collision = collide(5e-3, end=0.5e-3, times=(0.4e-3, 0.0))
    at = [snapshot.time for snapshot in collision.snapshots]
    assert at == pytest.approx([0.0, 0.4e-3], abs=1e-12)
    start, pressed = collision.snapshots
    assert start.percentile(100.0) < 1.0
    assert start.points == pytest.approx(collision.mesh.points)
    assert 0.0 < pressed.percentile(50.0) < pressed.percentile(95.0) < pressed.von_mises.max()
    assert pressed.element_von_mises.shape == (len(collision.mesh.elements),)


def test_two_millimetres_lie_as_far_from_the_fine_reference_as_its_own_coarse_run():
    collision = collide(2e-3)
    assert collision.energy_error < 2e-3
    fine, coarse = distance(collision), distance(collision, "coarse")
    assert fine.force < 0.24
    assert fine.impulse < 0.03
    assert coarse.force < 0.12
    assert coarse.impulse < 0.015
