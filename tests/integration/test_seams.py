"""Flush bodies side by side are one floor: what slides over a seam must not feel it."""

import math

import numpy as np
import pytest

import mpmfw

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
    return {
        "grid": {"cell_size": CELL, "lower": [-1.3] * 2, "upper": [1.6] * 2},
        "time": {"end": 0.25, "output_interval": 0.01},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": 0.0},
        "materials": {"soft": MATERIAL, "hard": HARD},
        "bodies": {
            "block": block,
            **{f"tile{k}": box("hard", BEGIN + k * length, length, -0.2, 0.0) for k in range(tiles)},
        },
        "loads": {"weight": {"model": "body_force", "bodies": ["block"], "force": force}},
        "output": {"particles": False, "surface": False},
    }


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


@pytest.mark.parametrize(
    ("contact", "angle", "loss"),
    [("bardenhagen(criterion=position, normal=master)", 0.35, 3e-3), ("nairn", 0.0, 0.015)],
)
def test_tiles_are_one_floor_at_nodes(contact, angle, loss):
    """Tiles move alike, so that the normals of a node are of the block against all of them."""
    along = np.array([math.cos(angle), math.sin(angle)])
    run = mpmfw.run(floor_of_tiles(3, angle), contact=contact)
    speed = float(run["series"]["mean_velocity"].sel(body="block").values[-1] @ along)
    assert speed == pytest.approx(SPEED, rel=loss)


def test_two_bodies_alone_have_no_list_of_covered_facets():
    for tiles, listed in ((1, False), (2, True)):
        surface = mpmfw.Simulation(floor_of_tiles(tiles)).state.surface
        assert surface is not None
        assert (len(surface.covered) > 0) == listed
