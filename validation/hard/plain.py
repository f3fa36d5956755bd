"""Scenes that have a grid of their own, by name; Erleben's and PolyFEM's, and Chrono's stopping distance.

Erleben (2018), Methodology for assessing mesh-based contact point methods; parameters as in PolyFEM's
examples of contact in the plane.
"""

import math
from typing import Any

from common import disc, fixed, polygon, rectangle
from made import BELOW, plane, scene, trough

#: A wedge-shaped hollow of 2 m by 2 m.
HOLLOW = polygon(
    [[-1.2, -0.2], [1.2, -0.2], [1.2, 2.0], [1.0, 2.0], [0.0, 0.0], [-1.0, 2.0], [-1.2, 2.0]], sides=BELOW
)
HOLE = trough(0.25, 1.0, 1.5, -0.2, floor=0.2)
SLOT = trough(0.502, 1.5, 1.0, -0.2)


def spike(y: float, x: float = 0.0) -> dict[str, Any]:
    """Return a spike 3 m high with its tip at (x, y)."""
    return polygon([[x, y], [x + 0.5, round(y + 3.0, 9)], [x - 0.5, round(y + 3.0, 9)]])


def square(left: float, bottom: float, side: float, **body: Any) -> dict[str, Any]:
    """Return a square."""
    return rectangle(left, bottom, round(left + side, 9), round(bottom + side, 9), **body)


def stopping(friction: float, end: float, right: float, upper: float) -> dict[str, Any]:
    """Return a block of 1 m/s on a plane, settled at rest, which then has its speed at once.

    It stops after v² / 2 μ g (Chrono: utest_SMC_sliding_gravity, 0.5 %).
    """
    bodies = {
        "block": rectangle(0.03, 0.013, 0.63, 0.313, E=12e6, nu=0.3, velocity=[1.0, 0.0]),
        "plane": plane(-0.4, -0.2, right, 0.013, E=100e6, nu=0.3),
    }
    more = {"friction": friction, "gravity": 10.0, "settled": True}
    return _plain([-0.8, -0.4], [upper, 0.8], end, **more, **bodies)


def _plain(low: Any, high: Any, end: float = 1.0, cell: float = 0.1, **further: Any) -> dict[str, Any]:
    grid = {"cell_size": cell, "lower": list(low), "upper": list(high)}
    return {**scene(cell, end, **further), "grid": grid}


SCENES = {
    "cliff-edges": _plain(
        [-1.5, -0.4], [1.5, 2.8], lower=plane(-0.5, 0.0, 0.5, 1.0), upper=square(-0.5, 1.02, 1.0)
    ),
    "five-squares": _plain(
        *([-0.6, -0.2], [0.6, 1.3]),
        end=0.6,
        cell=0.05,
        floor=plane(-0.5, -0.1, 0.5, 0.0, E=10e6),
        **{f"square_{k}": square(-0.1, round(0.005 + 0.205 * k, 9), 0.2, E=0.1e6) for k in range(5)},
    ),
    "golf-ball": _plain(
        *([-0.08, -0.06], [0.09, 0.06]),
        end=0.0012,
        gravity=0.0,
        cell=0.0025,
        ball=disc(-0.004, 0.0, 0.02, E=10e6, nu=0.45, rho=1150, velocity=[67.0, 0.0]),
        wall=rectangle(0.0175, -0.05, 0.0275, 0.05, E=1e9, nu=0.3, rho=1150, sides=fixed(right="xy")),
    ),
    "internal-edges": _plain(
        *([-2.8, -0.4], [2.8, 1.6]),
        left=plane(-2.4, -0.2, 0.0, 0.0),
        right=plane(0.002, -0.2, 2.4, 0.0),
        slider=square(-1.5, 0.02, 1.0, velocity=[2.0, 0.0]),
    ),
    "mass-ratio": _plain(
        *([-0.8, -0.1], [0.8, 1.3]),
        end=0.2,
        friction=0.1,
        cell=0.025,
        floor=plane(-0.7, -0.05, 0.7, 0.0, E=10e6),
        small=square(-0.05, 0.002, 0.1),
        large=square(-0.5, 0.104, 1.0, E=100e6, rho=10000),
    ),
    "slot": _plain(
        *([-2.0, -0.6], [2.0, 3.4]),
        end=0.8,
        slot=SLOT,
        triangle=polygon([[-0.5, 1.55], [0.5, 1.55], [0.0, 2.55]]),
    ),
    "spike-in-hole": _plain([-2.0, -0.6], [2.0, 6.0], hole=HOLE, spike=spike(0.5)),
    "spike-in-wedge": _plain([-2.0, -0.6], [2.0, 5.0], wedge=HOLLOW, spike=spike(0.55)),
    "spikes": _plain(
        *([-3.5, -2.4], [3.5, 7.0]),
        lower=polygon([[-0.5, 0.0], [0.5, 0.0], [0.0, 3.0]], sides=BELOW),
        upper=spike(3.03, 0.013),
    ),
    "stiffness-ratio": _plain(
        *([-1.2, -0.4], [1.2, 2.6]),
        end=0.8,
        gravity=1.0,
        lower=plane(-0.5, 0.0, 0.5, 1.0, E=10e3),
        upper=square(-0.5, 1.02, 1.0, E=100e6),
    ),
    "stopping-0.1": stopping(0.1, 1.15, 2.1, 2.5),
    "stopping-0.3": stopping(0.3, 0.383, 1.77, 2.2),
    "stopping-0.5": stopping(0.5, 0.23, 1.7, 2.1),
    "vertex-on-vertex": _plain(
        *([-2.0, -1.2], [2.0, 1.2]),
        end=0.6,
        gravity=0.0,
        left=square(-1.24, -0.5, 1.0, angle=math.radians(45.0), velocity=[1.0, 0.0]),
        right=square(0.24, -0.5, 1.0, angle=math.radians(45.0), velocity=[-1.0, 0.0]),
    ),
    "wedge-in-wedge": _plain(
        *([-2.0, -0.6], [2.0, 4.0]), lower=HOLLOW, upper=polygon([[0.0, 0.15], [0.75, 1.65], [-0.75, 1.65]])
    ),
}
