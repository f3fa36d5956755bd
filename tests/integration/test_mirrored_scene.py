"""A mirrored scene gives mirrored motion: no index of a node, facet or body decides."""

import numpy as np
import pytest

from contact_scenes import CELL, MATERIALS, STRATEGIES, body
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene

CONTACTS = {name: STRATEGIES[name] for name in STRATEGIES if name != "bardenhagen-specified"}
CONTACTS["adhesion"] = ("adhesion", {"traction": 2e3, "separation": 0.1 * CELL})


def motion(method, options, side):
    """Centres, velocities and spins of a spinning disc that hits a block, with x times ``side``."""
    outline = [[-0.6 * side, -0.41], [0.62 * side, -0.40], [0.6 * side, -0.1], [-0.6 * side, -0.12]]
    hit = {"velocity": [0.8 * side, -1.5], "angular_velocity": 3.0 * side}
    circle = {"type": "disc", "centre": [0.11 * side, 0.17], "radius": 0.22}
    scene = {
        "grid": {"cell_size": CELL, "lower": [-1.0, -1.0], "upper": [1.0, 1.0]},
        "time": {"end": 0.06, "output_interval": 0.02},
        "shape": {"method": "cpdi"},
        "contact": {"method": method, "friction": 0.3, method: options},
        "materials": MATERIALS,
        "bodies": {
            "disc": body(circle, kind="firm", layout="fitted", **hit),
            "block": body({"type": "polygon", "points": outline}, kind="ground"),
        },
    }
    if method in ("none", "separate"):
        del scene["contact"]["friction"], scene["contact"][method]
    frames = []
    Simulation(load_scene(scene)).run(frames.append)
    signs = {"centre_of_mass": [side, 1.0], "mean_velocity": [side, 1.0], "angular_velocity": [side]}
    return np.concatenate([(f.series[name] * signs[name]).ravel() for f in frames for name in signs])


@pytest.mark.parametrize("name", CONTACTS)
def test_a_mirrored_scene_gives_mirrored_motion(name):
    ahead, back = motion(*CONTACTS[name], 1.0), motion(*CONTACTS[name], -1.0)
    assert np.abs(ahead - back).max() < 1e-11
