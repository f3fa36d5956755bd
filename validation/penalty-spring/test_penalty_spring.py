"""Penalty spring: the stable step of two rigid masses kept in contact, Δt < 2 / √(k / m_red)."""
# cost: 15

import math
from pathlib import Path

from mpmfw.errors import SimulationError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.validation import SHAPES, methods

# Of scene.toml. The stiffness is that of one of two passes: k = κ M l_trib / (2 h), l_trib across the normal.
LIGHT, HEAVY = 1.0 * (0.02 * 0.02 + 0.5 * 0.02 * 0.004), 2.0 * 0.02 * 0.02  # kg/m
STIFFNESS = 0.5 * 1e4 * 0.01  # N/m²
REDUCED = LIGHT * HEAVY / (LIGHT + HEAVY)
LIMIT = 2.0 / math.sqrt(STIFFNESS / REDUCED)  # s

PRESSURE, HEIGHT = 1e-4, 0.02  # Pa, m: of the preload


def stays(step, shape, steps=600):
    """Return whether the pressed masses, a thousandth beside rest, stay within half of the rest's depth."""
    depth = PRESSURE * HEIGHT / STIFFNESS
    gap = -0.999 * depth  # of the plate from the tip
    values = {
        "bodies.plate.geometry.lower": [0.5 + gap, 0.49],
        "bodies.plate.geometry.upper": [0.52 + gap, 0.51],
        "shape.method": shape,
    }
    for body, side in (("tip", "left"), ("plate", "right")):
        values[f"bodies.{body}.sides"] = [{"side": side, "pressure": PRESSURE}]
    sim = Simulation(load_scene(Path(__file__).with_name("scene.toml"), set=values))
    sim.start()
    for _ in range(steps):
        try:
            sim.step(step)
        except SimulationError:
            return False
        rows = sim.contact.last_rows
        gap = rows.gap[: rows.count].min(initial=0.0)
        if not -1.5 * depth < gap < -0.5 * depth:
            return False
    return True


def largest_stable(shape, relative):
    """Return the largest stable step between half and one and a half of the limit [s], by bisection."""
    low, high = 0.5 * LIMIT, 1.5 * LIMIT
    if not stays(low, shape) or stays(high, shape):
        return math.nan
    while high / low > 1.0 + relative:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stays(middle, shape) else (low, middle)
    return math.sqrt(low * high)


def test_limit(case):
    for method in methods(shape=("cpdi", "cpdi2") if case.quick else SHAPES):
        with case.timed():
            found = largest_stable(method.shape, 0.01 if case.quick else 0.001)
        case.gate("largest stable step, error", 100.0 * (found / LIMIT - 1.0), 0.0, (-2.0, 2.0), "%", method)
