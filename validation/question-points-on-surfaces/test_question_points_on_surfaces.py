"""Question: contact at surface nodes or at quadrature points; the energy that impacts gain with nodes."""
# cost: 60

import math

import numpy as np
from common import rectangle, scene

from mpmfw.runs.simulation import Simulation
from mpmfw.stability import probe
from mpmfw.validation import Method

CELL, SIDE = 0.1, 0.3  #: [m]
DENSITY, BULK, SHEAR = 1000.0, 1e6 / 1.2, 1e6 / 2.6  #: [kg/m³], [Pa], [Pa]
SOLID = {"model": "neo_hookean", "density": DENSITY, "bulk_modulus": BULK, "shear_modulus": SHEAR}
SPEED = math.sqrt((BULK + 4.0 / 3.0 * SHEAR) / DENSITY)  #: of waves [m/s]


def impact(seed):
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
    for name, (x, y), angle, way in (("first", first, angles[0], 0.5), ("second", second, angles[1], -0.5)):
        moving = {"velocity": (way * speed * SPEED * along).tolist(), "particles": {"size": 0.5 * CELL}}
        half = 0.5 * SIDE
        bodies[name] = rectangle(float(x - half), float(y - half), float(x + half), float(y + half), **moving)
        bodies[name]["geometry"]["angle"] = float(angle)
    end = (3.0 / speed + 12.0) * CELL / SPEED
    output = {"particles": False, "surface": False}
    box = ([-1.5, -1.5], [1.5, 1.5])
    return scene(CELL, *box, end, end / 150.0, SOLID, bodies, contact={"friction": friction}, output=output)


def energy_gained(seed):
    """Return the largest kinetic, strain and contact energy of all steps over that at the start, less 1 [%].

    Positions and velocities are taken at the same time. NaN where the bodies did not meet.
    """
    made = impact(seed)
    steps = math.ceil(1.15 * made["time"]["end"] / Simulation(made).stable_step())
    found = probe(made, steps=steps)
    if found.status != "ok":
        raise RuntimeError(f"impact {seed}: {found.message}")
    return 100.0 * (found.stored - 1.0) if found.penetration > 0.0 else math.nan


IMPACTS, FEW = 200, 6  #: random impacts, and in the quick version
GAIN = 0.3  #: of energy by an impact, at most [%]


def test_impacts(case):
    gained = np.array([energy_gained(seed) for seed in range(FEW if case.quick else IMPACTS)])
    met, method = gained[np.isfinite(gained)], Method("penalty", "cpdi")
    case.gate("impacts: largest gain of energy", met.max(), "", (-100.0, GAIN), "%", method)
