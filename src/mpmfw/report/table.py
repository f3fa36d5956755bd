"""A comparison as rows: error, gap, spin and cost of every combination."""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from mpmfw import analysis
from mpmfw.fields import FloatArray
from mpmfw.references import RingsReference, RollingReference, cell_size_of, reference_of, rings_table

#: Heading and unit of each measured column.
COLUMNS: dict[str, tuple[str, str]] = {
    "displacement_error": ("Displacement error", "%"),
    "acceleration_error": ("Acceleration error", "%"),
    "spin_error": ("Spin error", "%"),
    "gap": ("End gap / h", "1"),
    "impulse_error": ("Impulse error", "%"),
    "impulse_curve_error": ("Impulse curve error", "%"),
    "energy_curve_error": ("Kinetic energy curve error", "%"),
    "force_error_100us": ("Force L2, 100 µs", "1"),
    "force_error_200us": ("Force L2, 200 µs", "1"),
    "first_contact": ("First contact", "ms"),
    "separation": ("Separation", "ms"),
    "cpu_time": ("CPU time", "s"),
    "steps": ("Steps", "1"),
    "material_points": ("Material points", "1"),
    "cost": ("CPU per particle and step", "ns"),
}


def method_dims(dataset: xr.Dataset) -> list[Hashable]:
    """Return the dimensions of the methods: contact, shape and what was varied."""
    return list(dataset["status"].dims)


def table(dataset: xr.Dataset) -> list[dict[str, Any]]:
    """Return one row for each combination of a comparison.

    Parameters
    ----------
    dataset
        Of ``compare``; which errors there are depends on the scene in its attributes.

    Returns
    -------
    list of dict
        The method's labels, ``status`` and the measures of :data:`COLUMNS` that apply; errors in per cent;
        NaN where a run did not reach the time of the measure.
    """
    reference = reference_of(dataset.attrs)
    dims = method_dims(dataset)
    rows = []
    for labels in itertools.product(*(dataset[dim].values.tolist() for dim in dims)):
        choice = dict(zip(dims, labels, strict=True))
        one = dataset.sel(choice)
        row: dict[str, Any] = {str(dim): label for dim, label in choice.items()}
        row["status"] = str(one["status"].item())
        if isinstance(reference, RollingReference):
            row |= rolling_measures(one, reference)
        elif isinstance(reference, RingsReference):
            row |= rings_measures(one, reference)
        if "min_gap" in one:
            row["gap"] = _last(one["min_gap"].isel(pair=0).values) / _cell_size(one)
        rows.append(row | _costs(one))
    return rows


def rolling_measures(run: xr.Dataset, reference: RollingReference) -> dict[str, float]:
    """Errors [%] of one run's series against the rigid rolling cylinder."""
    if "centre_of_mass" not in run:
        return dict.fromkeys(("displacement_error", "acceleration_error", "spin_error"), float("nan"))
    solution = reference.solution
    time = run["time"].values
    displacement = moved(run, reference.body)
    end = solution.time_to(reference.distance)
    fitted = analysis.fitted_acceleration(time, displacement, 0.2 * end, end)
    error = analysis.end_displacement_error(time, displacement, solution.acceleration, reference.distance)
    measures = {
        "displacement_error": 100.0 * error,
        "acceleration_error": 100.0 * (fitted / solution.acceleration - 1.0),
    }
    if "angular_velocity" in run and solution.angular_acceleration != 0.0:
        spin = run["angular_velocity"].sel(body=reference.body, rotation="z").values
        measures["spin_error"] = 100.0 * (
            analysis.value_at(time, spin, end) / float(solution.spin(end)) - 1.0
        )
    return measures


def rings_measures(run: xr.Dataset, reference: RingsReference) -> dict[str, float]:
    """Errors of one run's series against the finite-element rings; NaN for what it did not reach."""
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
        "energy_curve_error": _energy_error(run, reference),
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
    """Displacement of a body's centre of mass along x since the first output [m]; shape (time,)."""
    position = run["centre_of_mass"].sel(body=body, axis="x").values
    return np.asarray(position - position[0])


def _energy_error(run: xr.Dataset, reference: RingsReference) -> float:
    if "kinetic_energy" not in run:
        return float("nan")
    energy = rings_table("energy")
    exact = np.interp(run["time"].values, energy["time"], energy["fine_kinetic_J_per_m"])
    both = (
        run["kinetic_energy"].sel(body=[reference.first, reference.second]).sum("body", skipna=False).values
    )
    return 100.0 * float(np.max(np.abs(both - exact)) / exact[0])


def _costs(run: xr.Dataset) -> dict[str, float]:
    costs = {name: float(run[name]) for name in ("cpu_time", "steps", "material_points")}
    work = costs["steps"] * costs["material_points"]
    return {**costs, "cost": 1e9 * costs["cpu_time"] / work if work > 0.0 else float("nan")}


def _cell_size(run: xr.Dataset) -> float:
    """Cell size of one combination: varied, or the scene's."""
    return float(run["cell_size"]) if "cell_size" in run.coords else cell_size_of(run.attrs)


def _last(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(known[-1]) if len(known) else float("nan")


def shown(value: Mapping[str, Any] | float | str) -> str:
    """Format a cell: four significant digits, a dash for what is missing."""
    if isinstance(value, str):
        return value
    number = float(value)  # type: ignore[arg-type]
    if not np.isfinite(number):
        return "–"
    return f"{number:.0f}" if number == round(number) and abs(number) < 1e9 else f"{number:.3g}"
