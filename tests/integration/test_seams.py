"""Flush bodies side by side are one floor: what slides over a seam must not feel it."""

import math

import numpy as np
import pytest

import mpmfw
from scenes_for_tests import scene_of, solid

CELL, SPEED = 0.1, 2.0
#: Where the floor begins, and how long a tile is [m]: seams lie off the grid lines.
BEGIN, LENGTH = -0.487, 0.47

MATERIAL = {"model": "neo_hookean", "density": 1e3, "youngs_modulus": 1e7, "poissons_ratio": 0.3}
#: A thousand times as stiff at the same wave speed, so that tiles make no step under the load.
HARD = {**MATERIAL, "density": 1e6, "youngs_modulus": 1e10}


def floor_of_tiles(tiles, angle=0.0):
    """A frictionless block that slides over so many tiles, pressed on by its weight; turned by ``angle``."""
    e = np.array([math.cos(angle), math.sin(angle)])
    n = np.array([-math.sin(angle), math.cos(angle)])

    def box(kind, begin, length, low, high):
        centre, half = (begin + 0.5 * length) * e + 0.5 * (low + high) * n, [0.5 * length, 0.5 * (high - low)]
        shape = {"lower": (centre - half).tolist(), "upper": (centre + half).tolist(), "angle": angle}
        points = {"size": 0.05, "layout": "fitted"}
        return {"material": kind, "geometry": {"type": "rectangle", **shape}, "particles": points}

    length = 3 * LENGTH / tiles
    block = {**box("soft", BEGIN + 0.213, 0.4, 0.0, 0.2), "velocity": (SPEED * e).tolist()}
    force = [[0, 0, 0], [0.02, *(-3e4 * n).tolist()]]
    floor = {f"tile{k}": box("hard", BEGIN + k * length, length, -0.2, 0.0) for k in range(tiles)}
    return scene_of(
        {"block": block, **floor},
        *(CELL, [-1.3] * 2, [1.6] * 2),
        end=0.25,
        outputs=25,
        contact={"method": "penalty", "friction": 0.0},
        materials={"soft": MATERIAL, "hard": HARD},
        loads={"weight": {"model": "body_force", "bodies": ["block"], "force": force}},
        output={"particles": False, "surface": False},
    )


@pytest.mark.parametrize(
    ("contact", "angle"),
    [
        *((law, 0.0) for law in ("penalty(kappa=0.05)", "lcp", "barrier", "hybrid", "impulse", "midplane")),
        ("penalty", 0.35),
    ],
)
def test_a_block_slides_over_seams_without_a_brake(contact, angle):
    along = np.array([math.cos(angle), math.sin(angle)])
    run = mpmfw.run(floor_of_tiles(3, angle), contact=contact)
    speed = float(run["series"]["mean_velocity"].sel(body="block").values[-1] @ along)
    assert speed == pytest.approx(SPEED, rel=3e-3)


STRONGEST = "bardenhagen(criterion=position, normal=master)"


@pytest.mark.parametrize(
    ("contact", "angle", "loss"),
    [(STRONGEST, 0.0, 0.003), (STRONGEST, 0.35, 0.06), ("nairn", 0.0, 0.015), ("nairn", 0.35, 0.15)],
)
def test_tiles_are_one_floor_at_nodes(contact, angle, loss):
    """Tiles move alike, so that the normals of a node are of the block against all of them. On a slab `nairn`
    loses 8 % turned."""
    along = np.array([math.cos(angle), math.sin(angle)])
    run = mpmfw.run(floor_of_tiles(3, angle), contact=contact)
    speed = float(run["series"]["mean_velocity"].sel(body="block").values[-1] @ along)
    assert (1.0 - loss) * SPEED < speed < 1.003 * SPEED


def test_bodies_on_both_sides_of_a_strip_are_no_floor():
    """They move alike, but the strip of a cell lies between: it slides on, as far as `nairn` lets it."""
    scene = floor_of_tiles(2)
    low, strip, high = -0.437, -0.037, 0.063

    driven = {"sides": [{"side": "top", "velocity": [0.0, -0.02]}], "velocity": [0.0, -0.02]}
    scene["bodies"] = {
        "low": solid([-0.6, low], [0.6, strip], 0.025, sides=[{"side": "bottom", "fixed": True}]),
        "strip": solid([-0.4, strip], [0.4, high], 0.025, velocity=[1.0, 0.0]),
        "high": solid([-0.6, high], [0.6, 0.463], 0.025, **driven),
    }
    scene["time"]["end"] = 0.2
    del scene["loads"]
    run = mpmfw.run(scene, contact="nairn")
    assert float(run["series"]["mean_velocity"].sel(body="strip", axis="x")[-1]) > 0.75


def test_two_bodies_alone_have_no_list_of_covered_facets():
    for tiles, listed in ((1, False), (2, True)):
        surface = mpmfw.Simulation(floor_of_tiles(tiles)).state.surface
        assert surface is not None
        assert (len(surface.covered) > 0) == listed
