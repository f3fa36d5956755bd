"""Barriers in motion: what began apart never overlaps, and steps are cut before nodes touch."""

import math

import numpy as np
import pytest
import shapely

from contact_scenes import CELL, body, disc, rectangle, run, scene
from mpmfw.errors import SimulationError
from mpmfw.runs.simulation import Simulation

WAVES = 10.0  # m/s in the soft body


def polygon(centre, turn, speed, kind):
    """A square of 0.4 m that stands on a corner, but for ``turn`` [rad]."""
    angle = turn + np.arange(4) * 0.5 * math.pi
    points = [[centre[0] + 0.28 * math.cos(a), centre[1] + 0.28 * math.sin(a)] for a in angle]
    geometry = {"type": "polygon", "points": points}
    return body(geometry, kind=kind, layout="fitted", velocity=[speed, 0.0])


def meeting(form, speed, offset, slide, friction):
    """Two bodies a tenth of a cell or more apart that approach along x."""
    half = 0.5 * speed
    right = rectangle([0.0, -0.2 + offset], [0.4, 0.2 + offset], kind="stiff", velocity=[-half, slide])
    left = {
        "blocks": lambda: rectangle([-0.45, -0.2], [-0.05, 0.2], velocity=[half, 0.0]),
        "disc": lambda: disc([-0.3, 0.0], 0.25, velocity=[half, 0.0]),
        "corners": lambda: polygon([-0.35, 0.0], slide / 3.0, half, "soft"),
    }[form]()
    if form == "corners":
        right = polygon([0.3, 0.5 * offset], -slide / 4.0, -half, "stiff")
    return scene({"left": left, "right": right}, friction=friction)


def outlines(simulation):
    """The bodies' surfaces as polygons."""
    surface = simulation.state.surface
    return [shapely.Polygon(surface.position[surface.of(b)]) for b in range(2)]


@pytest.mark.parametrize("form", ["blocks", "disc", "corners"])
def test_bodies_that_began_apart_never_overlap(form):
    speed = 0.35 * WAVES
    simulation = Simulation(meeting(form, speed, -0.31, -1.5, 0.3), contact="barrier")
    simulation.start()
    nearest = np.inf
    while simulation.state.time < 0.45 / speed + 0.02:
        simulation.step()
        first, second = outlines(simulation)
        assert not first.intersects(second)
        nearest = min(nearest, first.distance(second))
    assert 0.0 < nearest < 0.1 * CELL  # they have met


def test_bodies_that_touch_in_the_scene_begin_without_a_force():
    bodies = {"left": rectangle([-0.4, -0.2], [0.0, 0.2]), "right": rectangle([0.0, -0.2], [0.4, 0.2])}
    simulation = Simulation(scene(bodies), contact="barrier")
    simulation.start()
    for _ in range(20):
        simulation.step()
    assert not simulation.contact.records.impulse.any()
    assert not simulation.state.particles.velocity.any()


def test_a_step_too_long_by_force_ends_the_run_and_says_where():
    simulation = Simulation(meeting("blocks", 4.0, 0.0, 0.0, 0.0), contact="barrier")
    simulation.start()
    with pytest.raises(SimulationError, match=r"left-right: a surface node came past its barrier.*body '"):
        run(simulation, 40, dt=8e-3)
