"""Scenes and measures of bodies that nearly keep their volume."""

from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq

YOUNG, RADIUS = 1e6, 0.5

#: Half of the discs' impulse at this time [s], and their largest force [N/m]: limits of smaller cells with ν
#: from 0.49 to 0.499.
TIME, FORCE = 0.0445, 24600.0


def material(density: float, young: float, poisson: float) -> dict[str, Any]:
    """Return a Neo-Hookean material."""
    return {"model": "neo_hookean", "density": density, "youngs_modulus": young, "poissons_ratio": poisson}


def discs(cells: int, poisson: float, volumetric: str) -> dict[str, Any]:
    """Return two discs that meet head-on at 1 m/s each; the plane of contact is off the grid lines."""
    bodies = {
        name: {
            "material": "rubber",
            "geometry": {"type": "disc", "centre": [side * 0.5005 + 0.0137, 0.0071], "radius": RADIUS},
            "particles": {"size": "0.5 cells", "layout": "fitted"},
            "velocity": [-side, 0.0],
            "volumetric": volumetric,
        }
        for name, side in (("left", -1.0), ("right", 1.0))
    }
    return {
        "grid": {"cell_size": RADIUS / cells, "lower": [-1.6, -0.9], "upper": [1.6, 0.9]},
        "time": {"end": 0.11, "output_interval": 0.0005, "outputs": "nearest"},
        "shape": {"method": "cpdi"},
        "contact": {"method": "lcp"},
        "materials": {"rubber": material(1e3, YOUNG, poisson)},
        "bodies": bodies,
        "output": {"ledger": True, "particles": False, "surface": False},
    }


def impact(tree: xr.DataTree) -> dict[str, float]:
    """Return errors of the ``time`` at which half of the impulse has passed and of the largest ``force``, a
    mean over 4.5 ms [%], and the ``restitution``."""
    series = tree["series"].to_dataset()
    time, force = series["time"].values, -series["contact_force"].values[:, 0, 0]
    passed = np.cumsum(force * np.gradient(time))
    momentum = series["linear_momentum"].sel(body="left", axis="x").values
    return {
        "time": 100.0 * float(np.interp(0.5, passed / passed[-1], time) / TIME - 1.0),
        "force": 100.0 * float(np.convolve(force, np.ones(9) / 9.0, "same").max() / FORCE - 1.0),
        "restitution": float(-momentum[-1] / momentum[0]),
    }


def roller(poisson: float, volumetric: str) -> dict[str, Any]:
    """Return a roller of ten cells to the radius between two hard plates that close at 0.1 m/s."""
    plate = {"material": "hard", "particles": {"size": 0.025}}

    def moved(name: str, low: float, high: float, speed: float) -> dict[str, Any]:
        shape = {"type": "rectangle", "lower": [-0.4, low], "upper": [0.4, high]}
        side = {"side": name, "velocity": [0.0, speed]}
        return {**plate, "geometry": shape, "sides": [side], "velocity": [0.0, speed]}

    return {
        "grid": {"cell_size": 0.05, "lower": [-0.9, -0.8], "upper": [0.9, 0.8]},
        "time": {"end": 0.4, "output_interval": 0.002},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty"},
        "materials": {"rubber": material(1e3, YOUNG, poisson), "hard": material(5e4, 5e7, 0.3)},
        "bodies": {
            "roller": {
                "material": "rubber",
                "geometry": {"type": "disc", "centre": [0.0, 0.0], "radius": RADIUS},
                "particles": {"size": 0.025, "layout": "fitted"},
                "volumetric": volumetric,
            },
            "low": moved("bottom", -0.65, -0.5, 0.05),
            "high": moved("top", 0.5, 0.65, -0.05),
        },
        "output": {"particles": False},
    }


def closing(force: float, modulus: float) -> float:
    """Return how far both plates close on the roller under a ``force`` a length [m] (Johnson, eq. 5.57)."""
    half_width = np.sqrt(4.0 * force * RADIUS / (np.pi * modulus))
    return 2.0 * force / (np.pi * modulus) * (2.0 * np.log(4.0 * RADIUS / half_width) - 1.0)


def force(tree: xr.DataTree, poisson: float) -> float:
    """Return the error of the force while the plates close by 2 to 4 %, by least squares [%]."""
    series = tree["series"]["contact_force"].sel(axis="y")
    series = 0.5 * (series.sel(pair="roller-low") - series.sel(pair="roller-high"))
    late = series.where(series["time"] > 0.2, drop=True)
    modulus = YOUNG / (1.0 - poisson**2)
    exact = np.array(
        [
            brentq(lambda each, way=0.1 * t: closing(each, modulus) - way, 1e-3, YOUNG)
            for t in late["time"].values
        ]
    )
    return 100.0 * float(late.values @ exact / (exact @ exact) - 1.0)
