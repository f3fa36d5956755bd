"""The stable step of bodies thinner than a cell, whose outer rows of nodes hold next to no mass."""

import numpy as np
import pytest

from mpmfw.errors import SceneError
from mpmfw.geometry import Ball, Box, Polygon, Ring
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import scene_of

CELL, BULK, SHEAR, DENSITY = 0.1, 8e5, 4e5, 1000.0
TICK = CELL / np.sqrt((BULK + 4.0 / 3.0 * SHEAR) / DENSITY)


def bar(width, angle=0.0):
    """A bar five cells long and so many wide, by a grid line."""
    low = 0.013 * CELL
    upper = [0.25 + low, low + width * CELL]
    return {"type": "rectangle", "lower": [-0.25 + low, low], "upper": upper, "angle": angle}


def disc(width):
    """A disc so many cells wide, about a node of the grid."""
    return {"type": "disc", "centre": [0.013 * CELL] * 2, "radius": 0.5 * width * CELL}


def scene(geometry, size, **time):
    """One free body, with points of so many cells."""
    elastic = {"model": "linear_elastic", "density": DENSITY, "bulk_modulus": BULK, "shear_modulus": SHEAR}
    body = {"material": "solid", "geometry": geometry, "particles": {"layout": "fitted", "size": size * CELL}}
    made = scene_of({"thin": body}, CELL, [-1.0, -1.0], [1.0, 1.0], end=1.0, materials={"solid": elastic})
    return made | {"time": {**made["time"], **time}}


def growth(mapping, step, steps=300):
    """By how much kinetic energy of noise has grown after some steps; each of its modes is there."""
    simulation = Simulation(mapping)
    p = simulation.state.particles
    p.velocity += 1e-8 * np.random.default_rng(1).standard_normal(p.velocity.shape)
    start = float((p.mass[:, None] * p.velocity**2).sum())
    for _ in range(steps):
        simulation.step(step)
        grown = float((p.mass[:, None] * p.velocity**2).sum()) / start
        if not grown < 1e6:
            return float("inf")
    return grown


@pytest.mark.parametrize(("made", "width"), [(bar, 0.05), (disc, 0.1), (disc, 0.5)])
def test_default_step_of_a_thin_body_is_stable(made, width):
    mapping = scene(made(width), 0.5 * width)
    assert growth(mapping, Simulation(mapping).stable_step()) < 4.0


@pytest.mark.parametrize(("made", "width", "step"), [(bar, 0.1, 0.5), (disc, 0.25, 0.6)])
def test_half_of_the_bulks_limit_is_not(made, width, step):
    mapping = scene(made(width), 0.5 * width) | {"allow_unstable": True}
    assert growth(mapping, step * TICK) > 1e6


@pytest.mark.parametrize(("width", "length"), [(4.0, 1.0), (1.0, 1.0), (0.25, 0.5), (0.04, 0.2)])
@pytest.mark.parametrize("angle", [0.0, 0.6])
def test_the_limit_is_the_root_of_cell_and_width(width, length, angle):
    (limit, owner), *_ = Simulation(scene(bar(width, angle), min(0.5, width))).limits()
    assert limit == pytest.approx(length * TICK, rel=1e-12)
    assert owner == f"bulk wave speed ({'h' if length == 1.0 else '√(h w)'} / c)"


def test_a_step_past_it_is_refused():
    with pytest.raises(SceneError, match=r"limit .* of bulk wave speed \(√\(h w\) / c\), of which 0\.8 is"):
        Simulation(scene(bar(0.1), 0.05, step=0.5 * TICK)).run()


@pytest.mark.parametrize(
    ("geometry", "width"),
    [
        (Ring(centre=(0.0, 0.0), inner_radius=0.8, outer_radius=1.0), 0.2),
        (Polygon(points=((0.0, 0.0), (3.0, 3.0), (2.9, 3.1), (-0.1, 0.1))), 0.1 * np.sqrt(2.0)),
        (Box(lower=(0.0, 0.0, 0.0), upper=(3.0, 0.2, 2.0), angles=(0.3, 0.5, 0.7)), 0.2),
        (Ball(centre=(0.0, 0.0, 0.0), radius=0.3), 0.6),
    ],
)
def test_width_is_that_of_the_body_however_it_is_turned(geometry, width):
    assert geometry.width == pytest.approx(width, rel=1e-9)


@pytest.mark.parametrize("shape", ["cpdi", "gimp"])
def test_a_foil_of_a_ten_thousandth_of_a_cell_meets_a_plane(shape):
    """Its nodes carry less than surface nodes of bodies of a cell that have left their points."""
    foil = {"type": "rectangle", "lower": [-0.2, 0.013], "upper": [0.2, 0.013 + 1e-4 * CELL]}
    mapping = scene(foil, 0.5, end=0.02, output_interval=0.02)
    plane = {"type": "rectangle", "lower": [-0.8, -0.3], "upper": [0.8, 0.013]}
    mapping["bodies"]["thin"] |= {"velocity": [0.0, -0.1]}
    mapping["bodies"]["plane"] = {"geometry": plane, "rigid": True}
    mapping |= {"shape": {"method": shape}, "contact": {"method": "penalty"}}
    simulation = Simulation(mapping)
    simulation.run()
    assert simulation.state.particles.velocity[:, 1] == pytest.approx(0.1, abs=0.02)
