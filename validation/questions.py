"""What the cases ``question-…`` share: scenes of other cases, noise of a force, and the look of their figures.

They answer, with figures, what [H17] (Hamad, Giridharan & Moormann, 2017, Procedia Engineering 175, 116-123) leaves
open or states without a measurement.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from rings import force_of, particles_of, series_of
from rolling import GRAVITY, RADIUS, SERIES_ONLY

from mpmfw.analysis import running_average
from mpmfw.fields import FloatArray

sys.path.insert(0, str(Path(__file__).parent / "contact-stress"))
from measures import PRESSURE, Points, points_of

STRESS = "../contact-stress/scene.toml"
BLOCK = "../sliding-block/scene.toml"

#: Energy balances and frames that no row needs are left out.
RINGS_SERIES: dict[str, Any] = {"output.particles": False, "output.ledger": False}
#: Rings of a quarter of the material points: four instead of sixteen in a cell.
RINGS_COARSE: dict[str, Any] = {**RINGS_SERIES, **particles_of("0.5 cells")}
#: Rolling, with outputs close enough to see a force chatter.
ROLLING_FINE: dict[str, Any] = {**SERIES_ONLY, "time.output_interval": 0.002}
#: Averages against which a force's noise is counted [s]: about two passages of a wave through the body, and what the
#: rings' forces are compared over.
ROLLING_WINDOW, RINGS_WINDOW = 0.02, 100e-6
#: Mass of the rolling cylinder [kg/m].
CYLINDER_MASS = 1000.0 * np.pi * RADIUS**2

BLUE, ORANGE, GREEN, PINK, GREY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "0.4"
REFERENCE: dict[str, Any] = {"color": "black", "linewidth": 0.9, "linestyle": "--"}

__all__ = ["GRAVITY", "PRESSURE", "RADIUS", "SERIES_ONLY", "Points", "points_of"]


def noise(time: FloatArray, force: FloatArray, window: float) -> float:
    """Root mean square of a force's departure from its running average, over that of the average [%]."""
    smooth = running_average(time, force, window)
    return float(100.0 * np.sqrt(np.mean((force - smooth) ** 2) / np.mean(smooth**2)))


def rolling_noise(tree: xr.DataTree) -> float:
    """Noise of the normal force on the cylinder, without the first 0.1 s after the sudden tilt [%]."""
    series = tree["series"].to_dataset()
    time = series["time"].values
    force = series["contact_force"].isel(pair=0).sel(axis="y").values
    return noise(time[time > 0.1], force[time > 0.1], ROLLING_WINDOW)


def rings_noise(tree: xr.DataTree) -> float:
    """Noise of the rings' force [%]."""
    return noise(*force_of(series_of(tree)), RINGS_WINDOW)


def segments(size: float, *bodies: str) -> dict[str, Any]:
    """Segments of ``size`` [cells] for the surfaces of some bodies."""
    return {f"bodies.{body}.segment": f"{size:g} cells" for body in bodies}


def cost_of(tree: xr.DataTree) -> dict[str, float]:
    """Steps, CPU time of the steps [s], and of contact within it [s]; settling is left out."""
    attributes = tree.attrs
    return {
        "steps": float(attributes["steps"]),
        "cpu": float(attributes["cpu_time"]),
        "contact": float(attributes["cpu_contact"]),
    }
