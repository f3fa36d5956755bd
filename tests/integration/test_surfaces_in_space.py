"""Penalty contact between surfaces of triangles."""

import numpy as np
import pytest

from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from scenes_for_tests import body_of, scene_of, solid

CELL = 0.25
SOFT = {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 12e6, "shear_modulus": 6e6}


def box(lower, upper, segment, **keys):
    """A box [cells] with triangles in rectangles of so many cells."""
    corners = [CELL * x for x in lower], [CELL * x for x in upper]
    return solid(*corners, 0.5 * CELL, layout="fitted", segment=segment * CELL, **keys)


def scene(bodies, upper=(4.0, 4.0, 9.0), **keys):
    """Bodies in a grid from −2 cells to ``upper`` [cells], 2 beyond."""
    tables = {"contact": {"method": "penalty", "friction": 0.3}, "materials": {"soft": SOFT}, **keys}
    return scene_of(bodies, CELL, [-2 * CELL] * 3, [CELL * (x + 2) for x in upper], end=1.0, **tables)


def test_the_order_of_bodies_decides_no_tie_of_facets():
    """A node above an edge is as close to both facets there, and rounding would choose; so would it in a
    turned frame."""
    motions = []
    for names in (["upper", "lower"], ["lower", "upper"]):
        upper = box((1.0, 1.0, 4.5), (5.0, 5.0, 8.5), 1 / 2, velocity=[1.2, 0.4, -4.0])
        upper["geometry"]["angles"] = [0.2, 0.1, 0.3]
        bodies = {"upper": upper, "lower": box((0.0, 0.0, 0.0), (6.0, 6.0, 3.9), 1 / 2)}
        sim = Simulation(scene({name: bodies[name] for name in names}, upper=(6.0, 6.0, 10.0)))
        sim.advance(45)
        motions.append({body.name: sim.state.particles.velocity[body.particles] for body in sim.state.bodies})
        assert (sim.contact.detection.candidates.gap < 0.0).any()
    for name, velocity in motions[0].items():
        np.testing.assert_allclose(velocity, motions[1][name], rtol=0.0, atol=1e-12)


def impact(method="penalty"):
    """A ball that spins hits the edge of a free box, both off the grid lines."""
    geometry = {"type": "ball", "centre": [0.31, 0.47, 1.18], "radius": 0.375}
    motion = {"velocity": [2.0, 1.0, -6.0], "angular_velocity": [5.0, -20.0, 8.0]}
    ball = body_of(geometry, 0.5 * CELL, **motion)
    bodies = {"ball": ball, "box": box((0.3, 0.2, 0.1), (3.3, 3.2, 3.1), 1 / 2)}
    return scene(bodies, contact={"method": method, "friction": 0.3})


def momentum(particles):
    return particles.mass @ particles.velocity


@pytest.mark.parametrize("method", ["penalty", "surfaces+hamad2017", "lcp", "hybrid"])
def test_impact_keeps_momentum_and_pushes_apart(method):
    sim = Simulation(load_scene(impact(method)))
    sim.advance(1)
    particles, ball = sim.state.particles, sim.state.bodies[0].particles
    before, speed = momentum(particles), particles.velocity[ball].mean(axis=0)
    touched = 0
    for _ in range(60):
        sim.step()
        touched += int((sim.contact.rows.gap[: sim.contact.rows.count] < 0.0).sum())
    assert touched > 20
    assert particles.velocity[ball].mean(axis=0)[2] > speed[2] + 0.3
    np.testing.assert_allclose(momentum(particles), before, atol=1e-12 * np.abs(before).max())
