"""Bodies keep their sides at any speed and load, or the run ends and says so: judged by shapely, which knows
no search.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest
import shapely

from contact_scenes import CELL, material
from mpmfw.api import SimulationError
from mpmfw.contact.surfaces import detection, near_facets
from mpmfw.effects.verdict import DEEP
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import scene_of

SOLID = material(1e6, 1000.0)  # K 1 MPa, G 0.5 MPa
C = math.sqrt((1e6 + 4.0 * 5e5 / 3.0) / 1000.0)  # m/s


def body(geometry, velocity=(0.0, 0.0), **keys):
    """A body with a velocity [c]; discs have particles that follow their outline."""
    layout = "fitted" if geometry["type"] == "disc" else "lattice"
    particles = {"layout": layout, "size": 0.5 * CELL}
    moving = {"velocity": [C * v for v in velocity]}
    return {"material": "solid", "geometry": geometry, "particles": particles, **moving, **keys}


def box(left, bottom, right, top, **keys):
    """A rectangle [cells]."""
    corners = {"lower": [CELL * left, CELL * bottom], "upper": [CELL * right, CELL * top]}
    return {"type": "rectangle", **corners, **keys}


def ball(x, y, radius):
    """A disc [cells]."""
    return {"type": "disc", "centre": [CELL * x, CELL * y], "radius": CELL * radius}


def scene(bodies, end, **keys):
    """A scene of these bodies, without friction, that ends at a time [h / c]."""
    materials = {"solid": SOLID, **keys.pop("materials", {})}
    tables = {"contact": {"method": "penalty", "friction": 0.0}, "output": {"particles": False}, **keys}
    corners = [-25 * CELL] * 2, [25 * CELL] * 2
    return scene_of(bodies, CELL, *corners, end * CELL / C, outputs=20, materials=materials, **tables)


def two(left, right, speed):
    """Two bodies that approach along x at ``speed`` [c] each, and the time for 3 cells at 0.5 c at most."""
    return scene(
        {"left": body(left, (speed, 0.0)), "right": body(right, (-speed, 0.0))}, 4.0 / min(speed, 0.5)
    )


TIP = 1.5 * math.sqrt(2.0)  # half a diagonal of a square of three cells
SCENES = {
    "head-on": lambda v: two(ball(-2.5, 0.0, 2.0), ball(2.5, 0.0, 2.0), v),
    "flat": lambda v: two(box(-4.1, -2.0, -0.1, 2.0), box(0.1, -2.0, 4.1, 2.0), v),
    "oblique": lambda v: two(box(-4.1, -2.0, -0.1, 2.0), box(0.1, -1.3, 4.1, 2.7, angle=0.1), v),
    "tip on tip": lambda v: two(
        box(-1.55 - TIP, -1.5, 1.45 - TIP, 1.5, angle=0.25 * math.pi),
        box(-1.45 + TIP, -1.4, 1.55 + TIP, 1.6, angle=0.25 * math.pi),
        v,
    ),
    "thin sheet": lambda v: scene(
        {"left": body(ball(-2.4, 0.0, 2.0), (2.0 * v, 0.0)), "right": body(box(-0.25, -6.0, 0.25, 6.0))},
        3.0 / v,
    ),
}


def outlines(simulation):
    """The bodies' outlines."""
    surface = simulation.state.surface
    assert surface is not None
    return [shapely.Polygon(surface.position[surface.of(b.index)]) for b in simulation.state.bodies]


def depth(simulation):
    """Deepest node of one body within the other [cells of the scene]."""
    surface, areas = simulation.state.surface, outlines(simulation)
    assert surface is not None
    deepest = 0.0
    for own, other in ((0, 1), (1, 0)):
        points = shapely.points(surface.position[surface.of(own)])
        inside = points[shapely.contains(areas[other], points)]
        if len(inside):
            deepest = max(deepest, float(shapely.distance(inside, areas[other].exterior).max()))
    return deepest / simulation.state.grid.cell_size


def behind(simulation):
    """How far the left body's mean lies to the right of the right one's, where they meet [cells]: negative is
    as it began.

    Of the right body only the material counts that is level with the left one: a sheet bends round what hits
    it."""
    p = simulation.state.particles
    left, right = (p.position[b.particles] for b in simulation.state.bodies)
    low, high = np.quantile(left[:, 1], [0.25, 0.75])
    level = right[(right[:, 1] > low) & (right[:, 1] < high)]
    return float(left[:, 0].mean() - level[:, 0].mean()) / CELL if len(level) else -np.inf


@dataclass
class Fate:
    """What became of a run."""

    message: str = ""  #: of the error that ended it
    overlap: float = 0.0  #: common area at the end, over that of the smaller body
    behind: float = -np.inf  #: largest of all outputs, in cells
    depth: float = 0.0  #: largest of all outputs, in cells


def fate(mapping):
    """Run a scene and look at it at 20 outputs."""
    simulation, found = Simulation(mapping), Fate()
    try:
        simulation.start()
        for output in range(1, 21):
            target = output * mapping["time"]["output_interval"]
            while simulation.state.time < target:
                simulation.step_towards(target)
            found.behind = max(found.behind, behind(simulation))
            found.depth = max(found.depth, depth(simulation))
    except SimulationError as error:
        found.message = str(error)
    areas = outlines(simulation)
    if all(area.is_valid for area in areas):
        found.overlap = areas[0].intersection(areas[1]).area / min(area.area for area in areas)
    return found


@pytest.mark.parametrize("name", SCENES)
def test_bodies_keep_their_sides_up_to_the_speed_of_waves(name):
    found = fate(SCENES[name](0.5))
    assert not found.message
    assert found.behind < 0.0
    assert found.depth < 1.0
    assert found.overlap < 0.16  # measured: 0.151 head-on, where either body is four cells across


def test_nothing_is_reported_of_slow_bodies():
    found = fate(SCENES["head-on"](0.05))
    assert not found.message
    assert found.behind < 0.0
    assert found.depth < DEEP


@pytest.mark.parametrize(("name", "speed"), [("head-on", 1.0), *((name, 2.0) for name in SCENES)])
def test_past_the_speed_of_waves_they_do_so_or_the_run_ends(name, speed):
    """Material that is struck at twice its wave speed may invert; what must not be is a good end with crossed
    bodies.
    """
    found = fate(SCENES[name](speed))
    assert found.message or found.behind < 0.0, found


def softened(name, speed, kappa):
    """A scene with springs of this stiffness."""
    mapping = SCENES[name](speed)
    mapping["contact"]["penalty"] = {"kappa": kappa}
    return mapping


def test_bodies_that_cross_end_the_run_with_pair_place_and_time():
    """Springs of a hundredth of the usual stiffness cannot hold two discs at 0.5 c each."""
    mapping = softened("head-on", 0.5, 0.01)
    said = r"left-right: the bodies have crossed: .* far side of '(left|right)'"
    with pytest.raises(SimulationError, match=said) as caught:
        Simulation(mapping).run()
    assert caught.value.body in ("left", "right")
    assert caught.value.position is not None
    assert 0.0 < caught.value.time < mapping["time"]["end"]


def test_the_distance_at_which_bodies_have_crossed(monkeypatch):
    """With none, corners that bulge past each other's sides are taken for it; far off, nothing is."""
    monkeypatch.setattr(detection, "CROSSED", 0.0)
    assert "have crossed" in fate(softened("flat", 0.2, 1.0)).message
    monkeypatch.setattr(detection, "CROSSED", 100.0)
    found = fate(softened("head-on", 0.5, 0.01))
    assert found.behind > 0.0
    assert "crossed" not in found.message


def test_with_a_longer_way_in_a_step_discs_at_the_speed_of_waves_are_torn(monkeypatch):
    """A shorter one would only take more steps."""
    soft = softened("head-on", 1.0, 1.0)
    assert not fate(soft).message
    monkeypatch.setattr(near_facets, "SHARE", 100.0)
    assert "inverted" in fate(soft).message
