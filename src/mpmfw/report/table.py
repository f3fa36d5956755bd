"""A comparison as rows: error, gap, spin and cost of every combination."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.results import analysis, references
from mpmfw.results.analysis import GAP_ROUND_OFF, ROUND_OFF
from mpmfw.results.conservation import dissipation
from mpmfw.results.references import RingsReference, RollingReference, rings_table
from mpmfw.results.selection import points_of
from mpmfw.results.stored_scene import cell_size, own_attributes, scene_of_results
from mpmfw.state.fields import FloatArray


@dataclass(frozen=True)
class Column:
    """One measure."""

    heading: str  #: on a page
    short: str  #: on a terminal
    unit: str  #: ``1`` for a plain number
    meaning: str  #: {body} and {distance} are those of a rolling reference
    signed: bool = False  #: shown with its sign


COLUMNS: dict[str, Column] = {
    "displacement_error": Column(
        "Displacement error",
        "disp.",
        "%",
        "along the plane, at the time when the closed form has moved by {distance:g} m",
        True,
    ),
    "acceleration_error": Column(
        "Acceleration error", "accel.", "%", "parabola fitted over the last 80 % of that time", True
    ),
    "spin_error": Column(
        "Spin error", "spin", "%", "Σ m r × v / Σ m r² at that time, against that of a rigid {body}", True
    ),
    "impulse_error": Column(
        "Impulse error", "impulse", "%", "total impulse on the second body after separation", True
    ),
    "impulse_curve_error": Column(
        "Impulse curve error", "curve", "%", "largest difference over time, relative to the total impulse"
    ),
    "energy_curve_error": Column(
        "Kinetic energy error", "energy", "%", "largest difference over time, relative to the initial energy"
    ),
    "energy_least": Column(
        "Energy kept, least",
        "E min",
        "1",
        "minimum of energy plus friction and damping, over the initial energy",
    ),
    "energy_most": Column(
        "Energy kept, most", "E max", "1", "maximum of the same; above 1 the run gained energy"
    ),
    "force_error_100us": Column(
        "Force, 100 µs", "L2 100", "1", "relative L2 difference of the contact force averaged over 100 µs"
    ),
    "force_error_200us": Column("Force, 200 µs", "L2 200", "1", "the same, averaged over 200 µs"),
    "force_noise": Column(
        "Force noise",
        "noise",
        "%",
        "rms deviation of the largest force from its mean over 20 outputs, over that mean",
    ),
    "dissipation": Column(
        "Dissipation", "lost", "%", "energy put in that is lost, mostly by the transfer", True
    ),
    "first_contact": Column("First contact", "first", "ms", "start of the first output with a contact force"),
    "separation": Column("Separation", "last", "ms", "end of the last output with a contact force"),
    "gap": Column(
        "End gap / h", "gap", "h", "between any two outlines at the end; negative where they overlap", True
    ),
    "penetration": Column("Mean penetration / h", "pen.", "h", "mean over the outputs, of the deepest pair"),
    "largest_penetration": Column("Largest penetration / h", "pen.max", "h", "maximum of the same"),
    "cpu_time": Column("CPU time", "CPU", "s", "of the steps, without compilation, settling and output"),
    "cost": Column("CPU per point and step", "ns", "ns", "CPU time over material points and steps"),
    "steps": Column("Steps", "steps", "1", "time steps from time zero to the end"),
    "material_points": Column("Material points", "points", "1", "of all bodies"),
    "settle_time": Column("Settling", "settle", "s", "CPU time before time zero"),
    "cpu_time_spread": Column("Spread of CPU time", "±", "s", "half the range of the repeats"),
}

#: Columns of words, which ``auto`` leaves to the shape function.
CHOICES = ("scheme", "transfer", "code")

#: Least size by unit; a smaller one is shown as 0.
_LEAST = {"1": ROUND_OFF, "%": ROUND_OFF, "h": GAP_ROUND_OFF}

#: Columns of the table of costs.
COSTS = ("cpu_time", "cpu_time_spread", "settle_time", "cost", "steps", "material_points")


def column_of(name: str) -> Column:
    """Return the column of a measure."""
    if name in COLUMNS:
        return COLUMNS[name]
    words = name.replace("_", " ")
    return Column(words.capitalize(), words.removesuffix(" error").replace(" ", "\n"), "%", "")


def meaning_of(name: str, reference: references.Reference | None) -> str:
    """Return how a measure was taken, with the body and the distance of a rolling ``reference``."""
    facts = {"body": "body", "distance": float("nan")}
    if isinstance(reference, RollingReference):
        facts = {"body": reference.body, "distance": reference.distance}
    return column_of(name).meaning.format(**facts)


def method_dims(dataset: xr.Dataset) -> list[Hashable]:
    """Return the dimensions of the methods."""
    return list(dataset["status"].dims)


def table(dataset: xr.Dataset) -> list[dict[str, Any]]:
    """Return one row for each combination, errors in per cent; NaN where a run did not reach the time."""
    rows = []
    for labels, one in points_of(dataset, method_dims(dataset)):
        row = labels | {name: str(one[name].item()) for name in CHOICES if name in dataset.data_vars}
        row["status"] = str(one["status"].item())
        if row.get("code"):
            row["shape"] = "its own"
        reference = references.reference_of(own_attributes(one))
        if isinstance(reference, RollingReference):
            row |= rolling_measures(one, reference)
        elif isinstance(reference, RingsReference):
            row |= rings_measures(one, reference)
        row |= {str(name): 100.0 * float(one[name]) for name in measured(dataset)}
        if "contact_force" in one and one.sizes.get("pair"):
            forces = one["contact_force"].transpose("pair", "time", ...).values
            most = int(np.argmax(np.nansum(forces.reshape(len(forces), -1) ** 2, axis=1)))
            row |= {"force_noise": 100.0 * analysis.force_noise(one["time"].values, forces[most])}
        if (scene := scene_of_results(own_attributes(one))) is not None:
            row |= {"dissipation": 100.0 * dissipation(one, scene)}
        if "min_gap" in one:
            row |= gap_measures(one["min_gap"].min("pair").values / cell_size(one))
        rows.append(row | _costs(one))
    if all(np.isnan(row.get("dissipation", np.nan)) for row in rows):  # of no run the works are known
        for row in rows:
            row.pop("dissipation", None)
    return rows


def measured(dataset: xr.Dataset) -> list[str]:
    """Return the names of relative errors that the campaign found."""
    dims = set(method_dims(dataset))
    names = (str(name) for name in dataset.data_vars if str(name).endswith("_error"))
    return [name for name in names if set(dataset[name].dims) == dims]


def rolling_measures(run: xr.Dataset, reference: RollingReference) -> dict[str, float]:
    """Return errors [%] against the rigid rolling cylinder."""
    if "centre_of_mass" not in run:
        return dict.fromkeys(("displacement_error", "acceleration_error", "spin_error"), float("nan"))
    solution = reference.solution
    time = run["time"].values
    displacement = moved(run, reference.body)
    end = solution.time_to(reference.distance)
    fitted = analysis.fitted_acceleration(time, displacement, 0.2 * end, end)
    measures = {
        "displacement_error": 100.0 * (analysis.value_at(time, displacement, end) / reference.distance - 1.0),
        "acceleration_error": 100.0 * (fitted / solution.acceleration - 1.0),
    }
    if "angular_velocity" in run and solution.angular_acceleration != 0.0:
        spin = run["angular_velocity"].sel(body=reference.body, rotation="z").values
        measures["spin_error"] = 100.0 * (
            analysis.value_at(time, spin, end) / float(solution.spin(end)) - 1.0
        )
    return measures


def gap_measures(gap: FloatArray) -> dict[str, float]:
    """Return the gap at the end, mean and largest penetration."""
    known = gap[np.isfinite(gap)]
    if len(known) == 0:
        return dict.fromkeys(("gap", "penetration", "largest_penetration"), float("nan"))
    depth = np.maximum(-known, 0.0)
    return {
        "gap": float(known[-1]),
        "penetration": float(depth.mean()),
        "largest_penetration": float(depth.max()),
    }


def rings_measures(run: xr.Dataset, reference: RingsReference) -> dict[str, float]:
    """Return errors against the finite-element rings."""
    kept = analysis.energy_kept(run)
    known = kept[np.isfinite(kept)]
    least, most = (known.min(), known.max()) if len(known) else (np.nan, np.nan)
    energies = {
        "energy_curve_error": _energy_error(run, reference),
        "energy_least": float(least),
        "energy_most": float(most),
    }
    measures = energies | _force_measures(run)
    if _reached(run) < reference.end * (1.0 - 1e-9):
        against = ("energy_curve_error", "impulse_curve_error", "force_error_100us", "force_error_200us")
        measures |= {name: float("nan") for name in against if name in measures}
    return measures


def _reached(run: xr.Dataset) -> float:
    ends = [
        run[name].dropna("time")["time"].values for name in ("kinetic_energy", "contact_force") if name in run
    ]
    return max((float(times[-1]) for times in ends if len(times)), default=0.0)


def _force_measures(run: xr.Dataset) -> dict[str, float]:
    if "contact_force" not in run:
        return {}
    time, table_ = run["time"].values, rings_table("force")
    force = -run["contact_force"].isel(pair=0).sel(axis="x").values  # the reference is of the other ring
    phases = analysis.contact_phases(time, force)
    exact = np.interp(time, table_["time"], table_["fine_impulse_Ns_per_m"])
    total = float(table_["fine_impulse_Ns_per_m"][-1])
    impulse = analysis.impulse(time, force)
    measures = {
        "impulse_curve_error": 100.0 * float(np.max(np.abs(impulse - exact))) / total,
        "first_contact": 1e3 * phases.first,
        "separation": 1e3 * phases.separation,
    }
    parted = np.isfinite(phases.separation)
    measures["impulse_error"] = 100.0 * (float(impulse[-1]) / total - 1.0) if parted else float("nan")
    for window in (100, 200):
        ours, theirs = (analysis.averaged(time, curve, 1e-6 * window) for curve in (impulse, exact))
        measures[f"force_error_{window}us"] = analysis.relative_l2(time, ours, theirs)
    return measures


def moved(run: xr.Dataset, body: str) -> FloatArray:
    """Return the displacement of a body along x [m], (time,)."""
    position = run["centre_of_mass"].sel(body=body, axis="x").values
    return np.asarray(position - position[0])


def _energy_error(run: xr.Dataset, reference: RingsReference) -> float:
    if "kinetic_energy" not in run:
        return float("nan")
    energy = rings_table("energy")
    exact = np.interp(run["time"].values, energy["time"], energy["fine_kinetic_J_per_m"])
    both = run["kinetic_energy"].sel(body=[reference.first, reference.second]).sum("body", skipna=False)
    return 100.0 * float(np.max(np.abs(both.values - exact)) / exact[0])


def _costs(run: xr.Dataset) -> dict[str, float]:
    costs = {name: float(run[name]) for name in ("cpu_time", "steps", "material_points")}
    costs |= {name: float(run[name]) for name in ("settle_time", "cpu_time_spread") if name in run}
    optional = {"settle_time": costs.get("settle_time", 0.0) > 0.0}
    optional["cpu_time_spread"] = np.isfinite(costs.get("cpu_time_spread", np.nan))
    costs = {name: value for name, value in costs.items() if optional.get(name, True)}
    work = costs["steps"] * costs["material_points"]
    return {**costs, "cost": 1e9 * costs["cpu_time"] / work if work > 0.0 else float("nan")}


def shown(value: Any, column: Column | None = None) -> str:
    """Format a cell to three significant digits."""
    if isinstance(value, str):
        return value
    number = float(value)
    if not np.isfinite(number):
        return "–"
    if column is not None and abs(number) < _LEAST.get(column.unit, 0.0):
        return "0"
    signed = column is not None and column.signed
    if number == 0.0 or (number == round(number) and not signed and abs(number) < 1e9):
        return f"{number:.0f}"
    sign = "+" if signed else ""
    number = float(f"{number:.3g}") if abs(number) < 100.0 else number
    if abs(number) >= 100.0:
        return f"{number:{sign}.0f}"
    if abs(number) >= 1e-3:
        digits = 3 if abs(number) < 1.0 else 2 if abs(number) < 10.0 else 1
        return f"{number:{sign}.{digits}f}"
    return f"{number:{sign}.0e}"
