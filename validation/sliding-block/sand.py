"""A rigid block that slides to rest on a bed of sand."""

from typing import Any

import numpy as np
import xarray as xr

FRICTION, SPEED, GRAVITY, DEPTH = 0.3, 1.0, 10.0, 0.4


def scene(cells: int) -> dict[str, Any]:
    """Return the block on sand so many ``cells`` deep."""
    cell = DEPTH / cells
    sand = {"model": "mohr_coulomb", "density": 1600.0, "youngs_modulus": 1e7, "poissons_ratio": 0.3}
    block = {"type": "rectangle", "lower": [0.6, DEPTH], "upper": [1.1, 0.6]}
    return {
        "grid": {"cell_size": cell, "lower": [-4.0 * cell, -4.0 * cell], "upper": [2.2, 1.0]},
        "time": {"end": 0.3, "output_interval": 0.01, "outputs": "nearest"},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty", "friction": FRICTION},
        "gravity": {"vector": [0.0, -GRAVITY]},
        "settle": {"tolerance": 1e-3},
        "materials": {"sand": sand | {"friction_angle": float(np.radians(33.0))}},
        "bodies": {
            "sand": {
                "material": "sand",
                "geometry": {"type": "rectangle", "lower": [0.0, 0.0], "upper": [2.0, DEPTH]},
                "particles": {"size": "0.5 cells"},
                "initial_stress": {"k0": 0.5},
                "sides": [
                    {"side": "bottom", "fixed": True},
                    {"side": "left", "fixed": ["x"]},
                    {"side": "right", "fixed": ["x"]},
                ],
            },
            "block": {
                "geometry": block,
                "velocity": [SPEED, 0.0],
                "rigid": {"density": 800.0, "held": ["rotation"]},
            },
        },
        "output": {"particles": False, "surface": False},
    }


def braking(tree: xr.DataTree) -> float:
    """Return the error [%] of the block's mean deceleration against μ g."""
    speed = tree["series"]["mean_velocity"].sel(body="block", axis="x")
    rate = np.polyfit(speed["time"].values, speed.values, 1)[0]
    return -100.0 * float(rate / (FRICTION * GRAVITY)) - 100.0
