"""The scenes of [H17] beside their references: motion and positions of the cylinder, force of the rings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.plots.histories import Beside, beside_reference
from mpmfw.plots.style import (
    Look,
    combinations,
    drawn_reference,
    drawn_values,
    head,
    journal_style,
    new_figure,
    on_lines,
)
from mpmfw.results import analysis
from mpmfw.results.references import (
    RingsReference,
    RollingReference,
    cell_size,
    grid_lower_of,
    own_attributes,
    rings_table,
)
from mpmfw.state.fields import FloatArray

#: Of the averaged force of the rings [s].
WINDOW = 100e-6


def motion(datasets: Sequence[xr.Dataset]) -> Figure:
    """Displacement, velocity and spin of the cylinder, and its displacement less that of the closed form.

    Runs whose cylinder hardly moves are left out of the last panel, where they would hide the others.

    Parameters
    ----------
    datasets
        Comparisons of rolling scenes; the closed form (eq. 13 of [H17]) is drawn in black.

    Raises
    ------
    ValueError
        A dataset is not of a rolling cylinder.
    """
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
    """Contact force of the rings as stored and averaged over 100 µs, and its impulse ([H17] figure 4).

    Parameters
    ----------
    dataset
        Comparison; the finite-element reference is drawn if the scene is the one it was computed for. Methods
        that report no contact force, such as ``none``, are left out.
    """
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


@journal_style()
def positions(dataset: xr.Dataset, shape: str | None = None) -> Figure:
    """First and last outlines, one row for each contact method; the gap at the end enlarged beside it.

    Parameters
    ----------
    dataset
        Comparison with ``outline``.
    shape
        Shape function whose outlines are drawn; the last one by default.

    Raises
    ------
    ValueError
        No run of that shape stored an outline.
    """
    drawn = [one for one in combinations(dataset) if np.isfinite(one[2]["outline"].values).any()]
    if not drawn:
        raise ValueError("no run of the comparison stored an outline")
    chosen = shape or drawn[-1][1]
    runs = [one for one in drawn if one[1] == chosen]
    if not runs:
        raise ValueError(f"no run with shape '{chosen}' stored an outline")
    figure = new_figure(2, len(runs), 40.0)
    head(figure, dataset)
    look = Look(dataset)
    panels = figure.subplots(len(runs), 2, squeeze=False, width_ratios=(6, 1))
    for row, ((axes, near), (contact, shape_name, run)) in enumerate(zip(panels, runs, strict=True)):
        # The start on top and dashed: it shows where the end covers it
        for frame, colour, style in (("last", look.colours[contact], "-"), ("first", "0.35", (0, (3, 3)))):
            for line in run["outline"].sel(frame=frame).values:
                axes.plot(line[:, 0], line[:, 1], color=colour, linestyle=style, linewidth=0.9)
        axes.set_aspect("equal")
        time = float(run["outline_time"].sel(frame="last"))
        letter = f"({chr(ord('a') + row)}) " if len(runs) > 1 else ""
        title = f"{contact}, {shape_name}: start (dashed) and {time:.3g} s{_gap_text(run)}"
        axes.set_title(letter + on_lines(title))
        axes.set_ylabel("y [m]")
        _closer(axes, near, run, look.colours[contact])
    panels[-1][0].set_xlabel("x [m]")
    return figure


def _gap_text(run: xr.Dataset) -> str:
    known = run["min_gap"].isel(pair=0).dropna("time").values if "min_gap" in run else np.empty(0)
    if len(known) == 0:
        return ""
    h = cell_size(run)
    size, what = abs(float(known[-1])), "gap" if known[-1] > 0.0 else "penetration"
    cells = f" = {size / h:.2g} cells" if h > 0.0 else ""
    return f", {what} {1e3 * size:.3g} mm{cells}"


def _closer(axes: Any, near: Any, run: xr.Dataset, colour: str) -> None:
    """Draw in ``near`` the place under the body that moved most, enlarged, over the cells of the grid."""
    outline = run["outline"]
    first, last = outline.sel(frame="first").values, outline.sel(frame="last").values
    near.set_xticks([])
    near.set_yticks([])
    there = np.isfinite(last).any(axis=(1, 2))
    if not there.any():
        near.set_axis_off()
        return
    travel = [
        np.nanmax(np.abs(line - start)) if known else 0.0
        for line, start, known in zip(last, first, there, strict=True)
    ]
    mover = last[int(np.argmax(travel))]
    x, y = mover[np.nanargmin(mover[:, 1])]
    span = 0.22 * float(np.nanmax(mover[:, 0]) - np.nanmin(mover[:, 0]))
    _draw_cells(near, run, (x, y), span)
    for line in last:
        near.plot(line[:, 0], line[:, 1], color=colour, linewidth=0.9, marker=".", markersize=2)
    near.set_aspect("equal")
    near.set_xlim(x - span, x + span)
    near.set_ylim(y - span, y + span)
    axes.indicate_inset_zoom(near, edgecolor="0.4", linewidth=0.6)


def _draw_cells(near: Any, run: xr.Dataset, centre: tuple[float, float], span: float) -> None:
    h, lower = cell_size(run), grid_lower_of(own_attributes(run))
    if not (h > 0.0 and len(lower) == 2):
        return
    for middle, start, draw in zip(centre, lower, (near.axvline, near.axhline), strict=True):
        for k in range(int(np.ceil((middle - span - start) / h)), int((middle + span - start) / h) + 1):
            draw(start + k * h, color="0.8", linewidth=0.5, zorder=0)
