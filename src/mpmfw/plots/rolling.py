"""The scenes of [H17] beside their references: motion of the cylinder, force of the rings."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.plots.histories import Beside, beside_reference
from mpmfw.plots.style import drawn_reference, drawn_values
from mpmfw.results import analysis
from mpmfw.results.references import RingsReference, RollingReference, rings_table
from mpmfw.state.fields import FloatArray

#: Of the averaged force of the rings [s].
WINDOW = 100e-6


def motion(datasets: Sequence[xr.Dataset]) -> Figure:
    """Draw motion and error of rolling cylinders, the error of those that move; else a ValueError."""
    comparisons = []
    for dataset in datasets:
        reference = drawn_reference(dataset)
        if not isinstance(reference, RollingReference):
            raise ValueError("not a comparison of a rolling cylinder")
        solution, time = reference.solution, dataset["time"].values
        run = dataset.sel(body=reference.body)
        x = run["centre_of_mass"].sel(axis="x")
        moved, velocity = x - x.isel(time=0), run["mean_velocity"].sel(axis="x")
        exact = xr.DataArray(solution.displacement(time), {"time": dataset["time"]})
        moves = abs(moved).max("time") > 0.5 * exact.where(moved.notnull()).max("time")
        series: dict[str, Beside] = {
            "displacement": (moved, "m", time, exact.values),
            "velocity": (velocity, "m s-1", time, solution.velocity(time)),
        }
        if "angular_velocity" in run:
            spin = -run["angular_velocity"].sel(rotation="z")
            series["clockwise spin"] = (spin, "rad s-1", time, -solution.spin(time))
        away = (moved - exact).where(moves)
        series["displacement error"] = (away, "m", time, np.zeros(len(time)))
        title = "slip" if solution.slips else "no slip"
        if len(datasets) > 1 and drawn_values(dataset):
            title = f"{title}, {drawn_values(dataset)}"
        comparisons.append((dataset, title, series))
    return beside_reference(comparisons, "closed form")


def contact_force(dataset: xr.Dataset) -> Figure:
    """Draw force of the rings, its mean and its impulse ([H17] figure 4)."""
    time, table = dataset["time"].values, rings_table("force")
    force = -dataset["contact_force"].isel(pair=0).sel(axis="x")  # on the pair's second body

    def over_time(function: Callable[[FloatArray], FloatArray]) -> xr.DataArray:
        dims = [["time"]]
        found: xr.DataArray = xr.apply_ufunc(
            function, force, input_core_dims=dims, output_core_dims=dims, vectorize=True
        )
        return found.where(force.notnull())

    known = isinstance(drawn_reference(dataset), RingsReference)
    inside = (table["time"] <= time[-1]) & known
    at, impulse = table["time"][inside], table["fine_impulse_Ns_per_m"]
    exact = analysis.averaged(table["time"], impulse, WINDOW)
    mean = over_time(lambda one: analysis.running_average(time, one, WINDOW))
    series: dict[str, Beside] = {
        "contact force": (force, "N m-1", at, table["fine_force_raw_N_per_m"][inside]),
        "mean over 100 µs": (mean, "N m-1", at, exact[inside]),
        "impulse": (over_time(lambda one: analysis.impulse(time, one)), "N s m-1", at, impulse[inside]),
    }
    return beside_reference([(dataset, "", series)], "finite elements, 0.5 mm", noisy="contact force")
