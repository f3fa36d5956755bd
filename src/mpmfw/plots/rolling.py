"""The rolling cylinder: motion against the closed form, first and last position ([H17] fig. 1, 2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpmfw.plots.style import (
    Look,
    combinations,
    drawn_reference,
    drawn_values,
    dress,
    head,
    journal_style,
    legend_below,
    new_figure,
    on_lines,
)
from mpmfw.results.references import RollingReference, cell_size, grid_lower_of, own_attributes

_EXACT: dict[str, Any] = {"color": "black", "linewidth": 0.8, "zorder": 5}


@journal_style()
def motion(datasets: Sequence[xr.Dataset]) -> Figure:
    """Displacement and velocity of the cylinder's centre, one row for each comparison (slip, no slip).

    Parameters
    ----------
    datasets
        Comparisons of rolling scenes; the closed form (eq. 13 of [H17]) is drawn in black.

    Raises
    ------
    ValueError
        A dataset is not of a rolling cylinder.
    """
    figure = new_figure(2, len(datasets))
    if len(datasets) == 1:
        head(figure, datasets[0])
    panels = figure.subplots(len(datasets), 2, squeeze=False)
    for row, dataset in zip(panels, datasets, strict=True):
        reference, look, time = _reference(dataset), Look(dataset), dataset["time"].values
        for turn, (contact, shape, run) in enumerate(combinations(dataset)):
            line = look.line(contact, shape, len(time), turn)
            x = run["centre_of_mass"].sel(body=reference.body, axis="x").values
            row[0].plot(time, x - x[0], **line)
            row[1].plot(time, run["mean_velocity"].sel(body=reference.body, axis="x").values, **line)
        row[0].plot(time, reference.solution.displacement(time), **_EXACT)
        row[1].plot(time, reference.solution.velocity(time), **_EXACT)
        case = "slip" if reference.solution.slips else "no slip"
        if len(datasets) > 1 and drawn_values(dataset):
            case = f"{case}, {drawn_values(dataset)}"
        dress(row[0], "time [s]", "displacement [m]", case)
        dress(row[1], "time [s]", "velocity [m/s]", case)
        for axes in row:
            axes.set_xlim(time[0], time[-1])
    widest = max(datasets, key=lambda dataset: dataset["status"].size)
    _legend(figure, widest)
    return figure


@journal_style()
def deviation(dataset: xr.Dataset) -> Figure:
    """Spin against the closed form, and by how much the displacement departs from it.

    Runs whose cylinder hardly moves are left out of the second panel, where they would hide the others.

    Parameters
    ----------
    dataset
        Comparison of a rolling scene; the closed form (eq. 13 of [H17]) is drawn in black.

    Raises
    ------
    ValueError
        The dataset is not of a rolling cylinder.
    """
    reference, look, time = _reference(dataset), Look(dataset), dataset["time"].values
    exact = reference.solution.displacement(time)
    figure = new_figure(2, 1)
    head(figure, dataset)
    spins, departs = figure.subplots(1, 2)
    for turn, (contact, shape, run) in enumerate(combinations(dataset)):
        line = look.line(contact, shape, len(time), turn)
        spins.plot(time, -run["angular_velocity"].sel(body=reference.body, rotation="z").values, **line)
        x = run["centre_of_mass"].sel(body=reference.body, axis="x").values
        last = np.flatnonzero(np.isfinite(x))[-1:]
        if np.all(np.abs(x[last] - x[0]) > 0.5 * exact[last]):
            departs.plot(time, x - x[0] - exact, **line)
    spins.plot(time, -reference.solution.spin(time), **_EXACT)
    departs.axhline(0.0, **_EXACT)
    dress(spins, "time [s]", "angular velocity, clockwise [rad/s]")
    dress(departs, "time [s]", "displacement − closed form [m]")
    for axes in (spins, departs):
        axes.set_xlim(time[0], time[-1])
    _legend(figure, dataset)
    return figure


def _reference(dataset: xr.Dataset) -> RollingReference:
    reference = drawn_reference(dataset)
    if not isinstance(reference, RollingReference):
        raise ValueError("not a comparison of a rolling cylinder")
    return reference


def _legend(figure: Figure, dataset: xr.Dataset) -> None:
    contacts, shapes = Look(dataset).key()
    exact = Line2D([], [], color="black", linewidth=0.8, label="closed form")
    legend_below(figure, [[exact, *contacts], shapes])


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
