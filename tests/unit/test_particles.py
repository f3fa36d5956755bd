"""Points that push each other apart within a step, as de Vaucorbeil & Nguyen (2021) have it, in closed
form.
"""

from __future__ import annotations

import numpy as np
import pytest

from measures_for_tests import detect
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import block, box

OVERLAP, MU = 0.01, 0.3


def overlapping(dim: int, slide: float = 0.0, friction: float = 0.0) -> Simulation:
    """Two squares or cubes of 0.5 m that overlap by 0.01 m, lattices of 4 points along an edge that face each
    other.
    """
    bodies = {}
    for name, left, speed in (("left", -0.5, slide), ("right", -OVERLAP, 0.0)):
        bodies[name] = {
            "material": "soft",
            "geometry": {
                "type": "rectangle" if dim == 2 else "box",
                "lower": [left, *[-0.25] * (dim - 1)],
                "upper": [left + 0.5, *[0.25] * (dim - 1)],
            },
            "particles": {"layout": "lattice", "size": 0.125},
            "velocity": [0.0, speed, *[0.0] * (dim - 2)],
        }
    scene = box() if dim == 3 else block()
    contact = {"method": "particles", "friction": friction}
    simulation = Simulation({**scene, "bodies": bodies, "contact": contact, "allow_overlap": True})
    simulation.start()
    return simulation


def impulse_of(simulation: Simulation) -> np.ndarray:
    """Change of the first body's momentum in its first step (dim,)."""
    p, own = simulation.state.particles, simulation.state.bodies[0].particles
    return (p.mass[own, None] * p.velocity[own]).sum(axis=0)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("dt", [1e-4, 2e-4])
def test_the_impulse_takes_the_overlap_out_in_one_step(dim, dt):
    """Σ m_p m_q / (m_p + m_q) overlap / Δt over the points that face each other."""
    simulation = overlapping(dim)
    before = impulse_of(simulation)
    simulation.step(dt)
    mass = 0.125**dim * simulation.state.bodies[0].density
    expected = 4 ** (dim - 1) * 0.5 * mass * OVERLAP / dt
    change = impulse_of(simulation) - before
    np.testing.assert_allclose(change, [-expected, *[0.0] * (dim - 1)], rtol=1e-12, atol=1e-12 * expected)
    np.testing.assert_allclose(simulation.contact.records.impulse[0], change, rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("slide", [1e-6, 1.0])
def test_friction_is_that_of_the_moment_however_slow_the_slip(slide):
    simulation, dt = overlapping(2, slide, MU), 1e-4
    before = impulse_of(simulation)
    simulation.step(dt)
    change = impulse_of(simulation) - before
    np.testing.assert_allclose(change[1], MU * change[0], rtol=1e-6)


def test_the_step_has_no_limit_but_the_bulk_s():
    simulation = overlapping(2)
    detect(simulation)
    assert [owner for _, owner in simulation.limits()] == ["bulk wave speed (h / c)"]


def test_points_that_touch_exchange_nothing():
    simulation = overlapping(2)
    simulation.state.particles.position[simulation.state.bodies[1].particles, 0] += OVERLAP + 1e-9
    simulation.step(1e-4)
    assert not simulation.contact.records.impulse.any()
