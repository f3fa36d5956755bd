"""Flush bodies side by side are one floor: what slides over a seam must not feel it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mpmfw
from mpmfw.contact import nodes

CELL, SPEED = 0.1, 2.0
#: Where the floor begins, and how long a tile is [m]: seams lie off the grid lines.
BEGIN, LENGTH = -0.487, 0.47

MATERIAL = {"model": "neo_hookean", "density": 1e3, "youngs_modulus": 1e7, "poissons_ratio": 0.3}
#: A thousand times as stiff at the same wave speed, so that tiles make no step under the load.
HARD = {**MATERIAL, "density": 1e6, "youngs_modulus": 1e10}


def floor_of_tiles(dim: int, tiles: int, angle: float = 0.0) -> dict[str, object]:
    """A frictionless block that slides over so many tiles, pressed on by its weight; turned by ``angle``
    [rad] in the plane.
    """
    e, n = np.eye(dim)[0], np.eye(dim)[-1]
    if dim == 2:
        e, n = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    across = [] if dim == 2 else [np.array([0.0, 0.3, 0.0])]

    def box(begin: float, length: float, low: float, high: float, wide: float) -> dict[str, object]:
        centre = (begin + 0.5 * length) * e + 0.5 * (low + high) * n
        half = [0.5 * length, *(wide * 0.15 for _ in across), 0.5 * (high - low)]
        if across:
            centre = centre + 0.5 * across[0]
        shape = {"lower": list(map(float, centre - half)), "upper": list(map(float, centre + half))}
        return {"type": "rectangle", **shape, "angle": angle} if dim == 2 else {"type": "box", **shape}

    points = {"size": 0.05, "layout": "fitted"} if dim == 2 else {"size": 0.05}
    whole = LENGTH * 3
    bodies: dict[str, object] = {
        "block": {
            "material": "soft",
            "geometry": box(BEGIN + 0.213, 0.4, 0.0, 0.2, 1.0),
            "particles": points,
            "velocity": [float(x) for x in SPEED * e],
        }
    }
    for k in range(tiles):
        length = whole / tiles
        bodies[f"tile{k}"] = {
            "material": "hard",
            "geometry": box(BEGIN + k * length, length, -0.2, 0.0, 2.0),
            "particles": points,
        }
    load = -3e4 * n
    return {
        "grid": {"cell_size": CELL, "lower": [-1.3] * dim, "upper": [1.6] * dim},
        "time": {"end": 0.25, "output_interval": 0.01},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": 0.0},
        "materials": {"soft": MATERIAL, "hard": HARD},
        "bodies": bodies,
        "loads": {
            "weight": {
                "model": "body_force",
                "bodies": ["block"],
                "force": [[0, *[0] * dim], [0.02, *map(float, load)]],
            }
        },
        "output": {"particles": False, "surface": False},
    }


def speed_at_the_end(scene: dict[str, object], contact: str, along: np.ndarray) -> float:
    """Speed of the block along the floor [m/s]."""
    run = mpmfw.run(scene, contact=contact)
    return float(run["series"]["mean_velocity"].sel(body="block").values[-1] @ along)


ON_SURFACES = ["penalty", "penalty(kappa=0.05)", "lcp", "barrier", "hybrid", "impulse", "midplane"]


@pytest.mark.parametrize("contact", ON_SURFACES)
def test_a_block_slides_over_seams_without_a_brake(contact: str) -> None:
    assert speed_at_the_end(floor_of_tiles(2, 3), contact, np.array([1.0, 0.0])) == pytest.approx(
        SPEED, rel=3e-3
    )


def test_seams_of_a_turned_floor_are_no_walls_either() -> None:
    along = np.array([math.cos(0.35), math.sin(0.35)])
    assert speed_at_the_end(floor_of_tiles(2, 3, 0.35), "penalty", along) == pytest.approx(SPEED, rel=3e-3)


@pytest.mark.parametrize("contact", ["bardenhagen(criterion=position, normal=master)", "nairn"])
@pytest.mark.parametrize(("tiles", "over"), [(2, False), (3, True)])
def test_contact_at_nodes_says_that_it_feels_seams(contact: str, tiles: int, over: bool) -> None:
    """The block begins on one of two tiles, or over the seam of two of three."""
    simulation = mpmfw.Simulation(floor_of_tiles(2, tiles), contact=contact)
    simulation.advance(1)
    assert any("a seam brakes" in text for text in simulation.concerns()) == over


def test_contact_at_nodes_looks_for_seams_now_and_then() -> None:
    """The block begins on one of two tiles, and slides over their seam."""
    contact = "bardenhagen(criterion=position, normal=master)"
    simulation = mpmfw.Simulation(floor_of_tiles(2, 2), contact=contact)
    simulation.advance(1)
    assert not simulation.contact.detection.seams
    while not simulation.contact.detection.seams:
        assert simulation.state.time < 0.2
        simulation.advance(1)
    assert simulation.state.steps % nodes.SEAMS_EVERY == 1  # found in the step after


@pytest.mark.parametrize(("tiles", "listed"), [(1, False), (2, True)])
def test_two_bodies_alone_have_no_list_of_covered_facets(tiles: int, listed: bool) -> None:
    surface = mpmfw.Simulation(mpmfw.load_scene(floor_of_tiles(2, tiles))).state.surface
    assert surface is not None
    assert (len(surface.covered) > 0) == listed
