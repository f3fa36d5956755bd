"""Print the table of docs/guide/stability.md on the stiffness of springs: ``python docs/make_stiffness.py``.

Two discs meet head-on. Half of the impulse has passed at 50.2 ms, the limit of small cells and stiff springs.
A minute. ``python docs/make_stiffness.py "0.17 ms"`` gives the discs that damping, of bulk and shear."""

from __future__ import annotations

import sys
import warnings
from typing import Any

import numpy as np

import mpmfw

KAPPAS = (1, 2, 4, 8)
CELLS = (4, 8, 16)  # to the radius
HALF = 0.0502  # [s]


def discs(cells: int) -> dict[str, Any]:
    """Discs of 0.5 m at 1 m/s each; the plane of contact lies off grid lines."""
    bodies = {
        name: {
            "material": "m",
            "geometry": {"type": "disc", "centre": [side * 0.5005 + 0.0137, 0.0071], "radius": 0.5},
            "particles": {"size": "0.5 cells", "layout": "fitted"},
            "velocity": [-side, 0.0],
        }
        for name, side in (("left", -1.0), ("right", 1.0))
    }
    solid: dict[str, Any] = {
        "model": "linear_elastic",
        "density": 1000,
        "youngs_modulus": 1e6,
        "poissons_ratio": 0.3,
    }
    if len(sys.argv) > 1:
        solid["damping"] = {"bulk": sys.argv[1], "shear": sys.argv[1]}
    return {
        "grid": {"cell_size": 0.5 / cells, "lower": [-1.6, -0.9], "upper": [1.6, 0.9]},
        "time": {"end": 0.11, "output_interval": 0.0005, "outputs": "nearest"},
        "shape": {"method": "cpdi"},
        "contact": {"method": "penalty"},
        "materials": {"m": solid},
        "bodies": bodies,
        "output": {"particles": False, "surface": False},
    }


def main() -> None:
    """Print a row for every cell size and contact."""
    print(
        "| R/h | contact | half of the impulse | restitution | CPU time |\n| --- | --- | ---: | ---: | ---: |"
    )
    for cells in CELLS:
        for contact in (*(f"penalty(kappa={kappa})" for kappa in KAPPAS), "lcp"):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                tree = mpmfw.run(discs(cells), contact=contact)
            series = tree["series"].to_dataset()
            time, force = series["time"].values, -series["contact_force"].values[:, 0, 0]
            passed = np.cumsum(force * np.gradient(time))
            half = float(np.interp(0.5, passed / passed[-1], time))
            speed = series["mean_velocity"].sel(body="left", axis="x").values
            error, cost = 100.0 * (half / HALF - 1.0), tree.attrs["cpu_time"]
            row = f"{error:+.1f} % | {-speed[-1] / speed[0]:.3f} | {cost:.2f} s"
            print(f"| {cells} | `{contact}` | {row} |", flush=True)


if __name__ == "__main__":
    main()
