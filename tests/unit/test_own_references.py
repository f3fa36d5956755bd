"""References that the validation computes: the sliding block of finite elements, the elastic sphere."""

import importlib
import math
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "validation" / "finite-elements"))

from rings_fem.element import add_internal_force
from slider_fem.bodies import DENSITY, GRAVITY, HEIGHT, LENGTH, incline
from slider_fem.flutter import contact_matrix, slide_steadily, stiffness_matrix
from slider_fem.motion import acceleration_of, slide

CONTACTS = ("springs", "impulses")
MASS = DENSITY * LENGTH * HEIGHT


def test_the_stiffness_is_that_of_small_motions_of_the_elements():
    bodies = incline(0.1, elastic=True)
    small = 1e-7 * np.random.default_rng(5).normal(size=bodies.points.shape)
    for solid in (bodies.block, bodies.plane):
        ahead, behind = np.zeros_like(small), np.zeros_like(small)
        add_internal_force(bodies.points + small, solid, ahead)
        add_internal_force(bodies.points - small, solid, behind)
        linear = stiffness_matrix(solid, len(small)) @ small.ravel()
        np.testing.assert_allclose(linear, 0.5 * (behind - ahead).ravel(), atol=1e-6 * np.abs(linear).max())


@pytest.mark.parametrize("friction", [0.0, 0.3, 0.9])
def test_steady_sliding_bears_the_weight_and_moves_pressure_to_the_front(friction):
    bodies = incline(0.05, elastic=True)
    state = slide_steadily(bodies, friction)
    gaps = contact_matrix(bodies, 1) @ state.displacement
    forces = np.where(state.pressed, -bodies.stiffness * gaps, 0.0)
    assert np.all(forces >= 0.0)
    assert forces.sum() == pytest.approx(MASS * GRAVITY)
    centre = forces @ bodies.points[bodies.bottom, 0] / forces.sum()
    # The moment of friction about the centre of mass: N e = T H / 2.
    assert centre == pytest.approx(0.5 * LENGTH + friction * 0.5 * HEIGHT, abs=2e-4)


@pytest.mark.parametrize("contact", CONTACTS)
def test_a_block_with_little_friction_has_coulombs_acceleration(contact):
    tilt, friction = math.radians(30.0), 0.1
    run = slide(0.1, friction, tilt, contact=contact, elastic=True)
    exact = GRAVITY * (math.sin(tilt) - friction * math.cos(tilt))
    assert acceleration_of(run.time, run.x) == pytest.approx(exact, rel=2e-3)


@pytest.fixture
def elastic(monkeypatch):
    """The elastic sphere of the case sphere-impacts."""
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[2] / "validation" / "sphere-impacts"))
    yield importlib.import_module("elastic")
    sys.modules.pop("elastic", None)


@pytest.mark.parametrize("poisson", [0.2, 0.3, 0.4])
def test_an_elastic_sphere_slides_throughout_beyond_the_limit_and_not_below(elastic, poisson):
    limit, ratio = elastic.sliding_from(poisson), elastic.ratio(poisson)
    for psi in (limit + 0.1, limit + 1.5, limit + 4.0):
        assert psi * elastic.rebound(psi / ratio, poisson) == pytest.approx(psi - limit - 1.0, abs=1e-6)
    psi = limit - 0.5
    assert psi * elastic.rebound(psi / ratio, poisson) > psi - limit - 1.0 + 1e-3
