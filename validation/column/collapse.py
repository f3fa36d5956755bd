"""A column of dry sand that collapses on a rough floor, and how far it runs."""

from typing import Any

import numpy as np
import xarray as xr

WIDTH, GRAVITY = 0.1, 9.81
#: Height of sand at the toe, over the width: three to five grains of the experiments.
TOE = 0.05


def run_out(aspect: float) -> float:
    """Return the run-out over the width in the experiments of Lube et al. (2005), plane."""
    return 1.2 * aspect if aspect < 1.8 else 1.9 * aspect ** (2.0 / 3.0)


def scene(aspect: float, cells: int, angle: float) -> dict[str, Any]:
    """Return a column so many ``cells`` wide and ``aspect`` times as high; ``angle`` is φ [degrees]."""
    cell, height = WIDTH / cells, aspect * WIDTH
    end, reach = 6.0 * float(np.sqrt(height / GRAVITY)), WIDTH * (1.0 + 2.4 * run_out(aspect))
    sand = {"model": "mohr_coulomb", "density": 1600.0, "youngs_modulus": 1e6, "poissons_ratio": 0.3}
    return {
        "grid": {
            "cell_size": cell,
            "lower": [-4.0 * cell, -4.0 * cell],
            "upper": [reach, 1.3 * height + 4.0 * cell],
        },
        "time": {"end": end, "output_interval": end / 5.0, "outputs": "nearest"},
        "shape": {"method": "gimp"},
        "contact": {"method": "none", "friction": 1.0},
        "gravity": {"vector": [0.0, -GRAVITY]},
        "materials": {"sand": sand | {"friction_angle": float(np.radians(angle))}},
        "bodies": {
            "sand": {
                "material": "sand",
                "geometry": {"type": "rectangle", "lower": [0.0, 0.0], "upper": [WIDTH, height]},
                "particles": {"size": "0.5 cells"},
                "initial_stress": {"k0": 0.5},
                "sides": [{"side": "left", "fixed": ["x"]}],
            },
            "floor": {
                "geometry": {
                    "type": "rectangle",
                    "lower": [-3.0 * cell, -3.0 * cell],
                    "upper": [reach - 2.0 * cell, 0.0],
                },
                "rigid": True,
            },
        },
        "output": {"surface": False},
    }


def deposit(tree: xr.DataTree, aspect: float) -> dict[str, float]:
    """Return the error [%] of the run-out at the ``toe``, and of that of 99 % of the sand, ``most``; the
    ``height`` at the wall over the width, and the ``volume`` that the sand has gained [%].

    The toe is where sand of its first volume, in bins of WIDTH / 10 from the wall on, is TOE WIDTH high."""
    points = tree["particles/sand"].to_dataset()
    place = points["position"].values[-1]
    bins = np.arange(0.0, 12.0, 0.1)
    depth = np.histogram(place[:, 0] / WIDTH, bins)[0] * aspect / len(place) / 0.1
    k = int(np.argmax(depth < TOE))
    toe = bins[k] - 0.05 + 0.1 * (depth[k - 1] - TOE) / (depth[k - 1] - depth[k])
    most, exact = float(np.quantile(place[:, 0], 0.99)) / WIDTH, run_out(aspect)
    return {
        "toe": 100.0 * float((toe - 1.0) / exact - 1.0),
        "most": 100.0 * ((most - 1.0) / exact - 1.0),
        "height": float(place[:, 1].max()) / WIDTH,
        "volume": 100.0 * float(np.linalg.det(points["deformation_gradient"].values[-1]).mean() - 1.0),
    }
