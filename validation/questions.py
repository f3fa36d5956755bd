"""What the cases ``question-…`` share: scenes of other cases, noise of a force, and the look of their
figures.

They answer, with figures, what [H17] (Hamad, Giridharan & Moormann, 2017, Procedia Engineering 175, 116-123)
leaves open or states without a measurement."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from rings import force_of, measures_of, series_of
from rolling import GRAVITY, RADIUS, SERIES_ONLY, errors

from mpmfw.results.analysis import running_average
from mpmfw.state.fields import FloatArray

sys.path.append(str(Path(__file__).parent / "contact-stress"))
from measures import PRESSURE, Points, points_of

STRESS = "../contact-stress/scene.toml"
BLOCK = "../sliding-block/scene.toml"

#: Averages against which a force's noise is counted [s]: about two passages of a wave through the body, and
#: what the rings' forces are compared over.
ROLLING_WINDOW, RINGS_WINDOW = 0.02, 100e-6
#: Mass of the rolling cylinder [kg/m].
CYLINDER_MASS = 1000.0 * np.pi * RADIUS**2


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


def of_rolling(tree: xr.DataTree, roll: str) -> dict[str, float]:
    """What the cases measure of a cylinder that rolls with ``slip`` or ``no slip``, and its cost."""
    return {**errors(tree, roll), **costs_of(tree)}


def of_rings(tree: xr.DataTree) -> dict[str, float]:
    """What the cases measure of the rings, the ``noise`` of their force [%], and their cost."""
    return {**measures_of(tree), "noise": rings_noise(tree), **costs_of(tree)}


#: The rings with a quarter of the material points, without points and ledger among the outputs.
FEW_POINTS = {
    "output.particles": False,
    "output.ledger": False,
    "bodies.left.particles.size": "0.5 cells",
    "bodies.right.particles.size": "0.5 cells",
}
#: Of a roll and of the rings: quantity, measure, reference and unit.
ROLL = (
    ("displacement, error", "displacement", 0.0, "%"),
    ("acceleration, error", "acceleration", 0.0, "%"),
    ("spin, error", "spin", 0.0, "%"),
    ("mean penetration", "penetration", "", "h"),
)
IMPACT = (
    ("impulse curve, largest error", "impulse_curve_error", "", "%"),
    ("force over 100 us, L2 error", "force_error_100us", "", ""),
    ("noise of the force", "noise", "", "%"),
    ("largest penetration", "largest_penetration", "", "h"),
)
COST = (("CPU time of a step", "step", "", "ms"), ("share of contact", "share", "", "%"))
WHOLE_COST = (("steps", "steps", "", ""), ("CPU time", "cpu", "", "s"))


def record_roll(run: Any, prefix: str, roll: str, *cost: tuple[Any, ...], noise: bool = False) -> None:
    """Record errors and cost of a roll, and the noise of its force."""
    for quantity, key, reference, unit in (*ROLL, *cost):
        run.gate(f"{prefix}: {quantity}", run.of(of_rolling, key, roll=roll), reference, unit=unit)
    if noise:
        run.gate(f"{prefix}: noise of the normal force", run.of(rolling_noise), unit="%")


def record_impact(run: Any, prefix: str, *rows: tuple[Any, ...]) -> None:
    """Record measures of the rings."""
    for quantity, key, reference, unit in rows:
        run.gate(f"{prefix}: {quantity}", run.of(of_rings, key), reference, unit=unit)


def of_blocks(tree: xr.DataTree) -> dict[str, float]:
    """Largest ``departure`` of σ_yy between two blocks, and that ``off the walls`` [%]."""
    points = points_of(tree)
    return {"departure": points.oscillation(), "off the walls": points.oscillation(margin=2.0)}


def costs_of(tree: xr.DataTree) -> dict[str, float]:
    """``steps``, CPU time ``cpu`` [s], that of a ``step`` [ms], and the ``share`` of contact in it [%]."""
    cost = cost_of(tree)
    share = 100.0 * cost["contact"] / cost["cpu"]
    return {
        "steps": cost["steps"],
        "cpu": cost["cpu"],
        "step": 1e3 * cost["cpu"] / cost["steps"],
        "share": share,
    }


def cost_of(tree: xr.DataTree) -> dict[str, float]:
    """Steps, CPU time of the steps [s], and of contact within it [s]; settling is left out."""
    attributes = tree.attrs
    return {
        "steps": float(attributes["steps"]),
        "cpu": float(attributes["cpu_time"]),
        "contact": float(attributes["cpu_contact"]),
    }
