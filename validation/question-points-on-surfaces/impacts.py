"""Random impacts of two squares, most of them corner on corner, and what they do to the energy."""

import math
from typing import Any

import numpy as np

from mpmfw.runs.simulation import Simulation
from mpmfw.stability import probe

CELL, SIDE = 0.1, 0.3  #: [m]
DENSITY, BULK, SHEAR = 1000.0, 1e6 / 1.2, 1e6 / 2.6  #: [kg/m³], [Pa], [Pa]
SOLID = {"model": "neo_hookean", "density": DENSITY, "bulk_modulus": BULK, "shear_modulus": SHEAR}
SPEED = math.sqrt((BULK + 4.0 / 3.0 * SHEAR) / DENSITY)  #: of waves [m/s]


def impact(seed: int) -> dict[str, Any]:
    """Return two squares that meet off centre, turned, at 0.01 to 0.16 of the wave speed."""
    random = np.random.default_rng(seed)
    angles = random.uniform(0.0, 0.5 * math.pi, 2)
    speed = 10.0 ** random.uniform(-2.0, -0.8)
    friction = float(random.choice([0.0, 0.3]))
    direction, aside = random.uniform(0.0, 2.0 * math.pi), random.uniform(-1.5, 1.5) * CELL
    along = np.array([math.cos(direction), math.sin(direction)])
    first = random.uniform(-0.5, 0.5, 2) * CELL
    second = first + 4.9 * CELL * along + aside * np.array([-along[1], along[0]])
    bodies = {}
    for name, centre, angle, way in (("first", first, angles[0], 0.5), ("second", second, angles[1], -0.5)):
        corners = {"lower": (centre - 0.5 * SIDE).tolist(), "upper": (centre + 0.5 * SIDE).tolist()}
        bodies[name] = {
            "material": "solid",
            "geometry": {"type": "rectangle", **corners, "angle": float(angle)},
            "particles": {"size": 0.5 * CELL},
            "velocity": (way * speed * SPEED * along).tolist(),
        }
    end = (3.0 / speed + 12.0) * CELL / SPEED
    return {
        "grid": {"cell_size": CELL, "lower": [-1.5, -1.5], "upper": [1.5, 1.5]},
        "time": {"end": end, "output_interval": end / 150.0},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": friction},
        "materials": {"solid": SOLID},
        "bodies": bodies,
        "output": {"particles": False, "surface": False},
    }


def energy_gained(seed: int) -> float:
    """Largest kinetic, strain and contact energy of all steps over that at the start, less 1 [%].

    Positions and velocities are taken at the same time. NaN where the bodies did not meet.
    """
    scene = impact(seed)
    steps = math.ceil(1.15 * scene["time"]["end"] / Simulation(scene).stable_step())
    found = probe(scene, steps=steps)
    if found.status != "ok":
        raise RuntimeError(f"impact {seed}: {found.message}")
    return 100.0 * (found.stored - 1.0) if found.penetration > 0.0 else math.nan
