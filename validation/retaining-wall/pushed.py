"""A smooth wall that gives way to soil, or pushes it, against Rankine's pressures."""

from typing import Any

import numpy as np
import xarray as xr

HEIGHT, DENSITY, GRAVITY, FRICTION = 2.0, 2e3, 10.0, np.radians(30.0)
#: Horizontal over vertical stress of Rankine's states, and at rest.
ACTIVE = float((1.0 - np.sin(FRICTION)) / (1.0 + np.sin(FRICTION)))
RATIOS = {"at rest": 0.5, "active": ACTIVE, "passive": 1.0 / ACTIVE}
#: Speed of the wall [m/s], out of the soil, and for how long it moves [s].
SPEEDS = {"at rest": (0.0, 0.1), "active": (-0.02, 0.6), "passive": (0.1, 0.9)}
WIDTH = 3.0  #: of the soil, all of which comes into Rankine's state [m]


def scene(state: str, cells: int, model: str = "mohr_coulomb") -> dict[str, Any]:
    """Return soil so many ``cells`` deep on a smooth floor, between a smooth moving wall and one at rest."""
    cell = HEIGHT / cells
    speed, end = SPEEDS[state]
    soil = {
        "model": model,
        "density": DENSITY,
        "youngs_modulus": 1e7,
        "poissons_ratio": 0.3,
        "friction_angle": float(FRICTION),
        "damping": {"critical": 0.01, "frequency": 10.0},
    }
    return {
        "grid": {
            "cell_size": cell,
            "lower": [-4.0 * cell, -4.0 * cell],
            "upper": [WIDTH + 4.0 * cell, 1.5 * HEIGHT],
        },
        "time": {"end": end, "output_interval": end / 60.0, "outputs": "nearest"},
        "shape": {"method": "cpdi"},
        "gravity": {"vector": [0.0, -GRAVITY]},
        "materials": {"soil": soil},
        "bodies": {
            "soil": {
                "material": "soil",
                "geometry": {"type": "rectangle", "lower": [0.0, 0.0], "upper": [WIDTH, HEIGHT]},
                "particles": {"size": "0.5 cells"},
                "initial_stress": {"k0": RATIOS["at rest"]},
                "sides": [
                    {"side": "bottom", "fixed": ["y"]},
                    {"side": "right", "fixed": ["x"]},
                    {"side": "left", "velocity": [speed, "free"]},
                ],
            }
        },
        "output": {"particles": False, "surface": False},
    }


def rough(cells: int, angle: float, volumetric: str = "auto") -> dict[str, Any]:
    """Return the soil on a floor as rough as the soil, against a wall of the wall friction ``angle``
    [degrees] that gives way."""
    made, cell = scene("active", cells), HEIGHT / cells
    made["time"] = {"end": 1.0, "output_interval": 0.02, "outputs": "nearest"}
    made["grid"]["lower"] = [-6.0 * cell, -4.0 * cell]
    made["bodies"]["soil"] |= {"sides": [{"side": "right", "fixed": ["x"]}], "volumetric": volumetric}
    speed = SPEEDS["active"][0]
    bodies = {
        "wall": {
            "geometry": {"type": "rectangle", "lower": [-3.0 * cell, 1e-6], "upper": [0.0, 1.3 * HEIGHT]},
            "rigid": {"motion": {"velocity": [[0.0, 0.0, 0.0], [0.1, speed, 0.0], [1.0, speed, 0.0]]}},
        },
        "floor": {
            "geometry": {
                "type": "rectangle",
                "lower": [-4.0 * cell, -3.0 * cell],
                "upper": [WIDTH + 3.0 * cell, 0.0],
            },
            "rigid": True,
        },
    }
    made["bodies"] |= bodies
    pairs = {
        "soil-wall": {"friction": float(np.tan(np.radians(angle)))},
        "soil-floor": {"friction": float(np.tan(FRICTION))},
    }
    return made | {"contact": {"method": "penalty", "pairs": pairs}, "settle": {"tolerance": 1e-3}}


def coulomb(tree: xr.DataTree, angle: float) -> dict[str, float]:
    """Return the error [%] of the wall's mean ``force`` over the last third against Coulomb's K_a cos δ ρ g
    H²/2, δ the ``angle`` [degrees], and how far friction over pressure is from tan δ [%], ``friction``."""
    force = tree["series"]["reaction"].sel(body="wall").values
    late, delta = np.abs(force[2 * len(force) // 3 :].mean(axis=0)), np.radians(angle)
    root = np.sqrt(np.sin(FRICTION + delta) * np.sin(FRICTION) / np.cos(delta))
    exact = (np.cos(FRICTION) / (1.0 + root)) ** 2 * 0.5 * DENSITY * GRAVITY * HEIGHT**2
    return {
        "force": 100.0 * float(late[0] / exact - 1.0),
        "friction": 100.0 * float(late[1] / late[0] / np.tan(delta) - 1.0),
    }


def pressure(tree: xr.DataTree, state: str) -> dict[str, float]:
    """Return the error [%] of the wall's mean ``force`` over the last third, when the soil yields, against
    K ρ g H²/2, and how far it ``varies`` there [%].

    H is that of soil that keeps its volume between the walls."""
    series = tree["series"]["side_force"].sel(body="soil", side="left", axis="x")
    force, moved = series.values[1:], SPEEDS[state][0] * series["time"].values[1:]
    share = force / (0.5 * DENSITY * GRAVITY * (HEIGHT * WIDTH / (WIDTH - moved)) ** 2)
    late = share[2 * len(share) // 3 :]
    return {
        "force": 100.0 * float(late.mean() / RATIOS[state] - 1.0),
        "varies": 100.0 * float(np.ptp(late) / late.mean()),
    }
