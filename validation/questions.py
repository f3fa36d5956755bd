"""What the cases ``question-…`` record of a roll and of the rings.

They answer what [H17] (Hamad, Giridharan & Moormann, 2017, Procedia Engineering 175, 116-123) leaves open or
states without a measurement."""

from typing import Any

import xarray as xr
from rings import force_of, measures_of, series_of
from rolling import errors

from mpmfw.results.analysis import force_noise

#: Averages against which a force's noise is counted [s]: about two passages of a wave through the body, and
#: what the rings' forces are compared over.
ROLLING_WINDOW, RINGS_WINDOW = 0.02, 100e-6

#: The rings with a quarter of the material points, without points and ledger among the outputs.
FEW_POINTS = {
    "output.particles": False,
    "output.ledger": False,
    "bodies.left.particles.size": "0.5 cells",
    "bodies.right.particles.size": "0.5 cells",
}
#: Of a roll and of the rings: quantity, key, reference, tolerance and unit.
ROLL = (
    ("displacement, error", "displacement", 0.0, None, "%"),
    ("acceleration, error", "acceleration", 0.0, None, "%"),
    ("spin, error", "spin", 0.0, None, "%"),
    ("mean penetration", "penetration", "", None, "h"),
)
IMPACT = (
    ("impulse curve, largest error", "impulse_curve_error", "", None, "%"),
    ("force over 100 us, L2 error", "force_error_100us"),
    ("noise of the force", "noise", "", None, "%"),
    ("largest penetration", "largest_penetration", "", None, "h"),
)
COST = (("CPU time of a step", "step", "", None, "ms"), ("share of contact", "share", "", None, "%"))
WHOLE_COST = (("steps", "steps"), ("CPU time", "cpu", "", None, "s"))


def record(run: Any, prefix: str, measure: Any, *rows: tuple[Any, ...], **args: Any) -> None:
    """Record what a measure gives, each quantity after a prefix."""
    run.gates(measure, *((f"{prefix}: {quantity}", *row) for quantity, *row in rows), **args)


def of_rolling(tree: xr.DataTree, roll: str) -> dict[str, float]:
    """Return errors of a cylinder that rolls with ``slip`` or ``no slip``, the ``noise`` of the normal force
    without the first 0.1 s after the sudden tilt [%], and the cost."""
    series = tree["series"].to_dataset().sel(axis="y")
    time, force = series["time"].values, series["contact_force"].isel(pair=0).values
    late = time > 0.1
    noise = 100.0 * force_noise(time[late], force[late], ROLLING_WINDOW)
    return {**errors(tree, roll), "noise": noise, **_costs(tree)}


def of_rings(tree: xr.DataTree) -> dict[str, float]:
    """Return measures of the rings, the ``noise`` of their force [%], and the cost."""
    noise = 100.0 * force_noise(*force_of(series_of(tree)), RINGS_WINDOW)
    return {**measures_of(tree), "noise": noise, **_costs(tree)}


def _costs(tree: xr.DataTree) -> dict[str, float]:
    """``steps``, CPU time ``cpu`` [s], that of a ``step`` [ms], and the ``share`` of contact in it [%].

    Settling is left out.
    """
    steps, cpu, contact = (float(tree.attrs[name]) for name in ("steps", "cpu_time", "cpu_contact"))
    return {"steps": steps, "cpu": cpu, "step": 1e3 * cpu / steps, "share": 100.0 * contact / cpu}
