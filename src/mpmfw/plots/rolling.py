"""The rolling cylinder: motion against the closed form, first and last position ([H17] fig. 1, 2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpmfw.plots.style import FONT, Look, combinations, dress, legend_below, new_figure
from mpmfw.references import RollingReference, reference_of


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
    panels = figure.subplots(len(datasets), 2, squeeze=False, sharex="row")
    for row, dataset in zip(panels, datasets, strict=True):
        reference = reference_of(dataset.attrs)
        if not isinstance(reference, RollingReference):
            raise ValueError("not a comparison of a rolling cylinder")
        look, time = Look(dataset), dataset["time"].values
        for turn, (contact, shape, run) in enumerate(combinations(dataset)):
            line = look.line(contact, shape, len(time), turn)
            x = run["centre_of_mass"].sel(body=reference.body, axis="x").values
            row[0].plot(time, x - x[0], **line)
            row[1].plot(time, run["mean_velocity"].sel(body=reference.body, axis="x").values, **line)
        row[0].plot(time, reference.solution.displacement(time), color="black", linewidth=0.8, zorder=5)
        row[1].plot(time, reference.solution.velocity(time), color="black", linewidth=0.8, zorder=5)
        case = "slip" if reference.solution.slips else "no slip"
        dress(row[0], "time [s]", "displacement [m]", case)
        dress(row[1], "time [s]", "velocity [m/s]", case)
    exact = Line2D([], [], color="black", linewidth=0.8, label="closed form")
    legend_below(figure, [exact, *Look(datasets[0]).key()])
    return figure


def positions(dataset: xr.Dataset, shape: str | None = None) -> Figure:
    """First and last outlines, one row for each contact method; the inset shows the gap at the end.

    Parameters
    ----------
    dataset
        Comparison with ``outline``.
    shape
        Shape function whose outlines are drawn; the last one by default.
    """
    runs = [
        (c, s, run) for c, s, run in combinations(dataset) if s == (shape or str(dataset["shape"].values[-1]))
    ]
    figure = new_figure(2, len(runs), 40.0)
    look = Look(dataset)
    panels = figure.subplots(len(runs), 1, squeeze=False, sharex=True)[:, 0]
    for axes, (contact, shape_name, run) in zip(panels, runs, strict=True):
        for frame, grey in (("first", "0.6"), ("last", look.colours[contact])):
            for line in run["outline"].sel(frame=frame).values:
                axes.plot(line[:, 0], line[:, 1], color=grey, linewidth=0.9)
        axes.set_aspect("equal")
        time = float(run["outline_time"].sel(frame="last"))
        dress(axes, "", "y [m]", f"{contact}, {shape_name}: start (grey) and {time:.3g} s{_gap_text(run)}")
        axes.grid(False)
        _closer(axes, run, look.colours[contact])
    panels[-1].set_xlabel("x [m]", fontsize=FONT)
    return figure


def _gap_text(run: xr.Dataset) -> str:
    if "min_gap" not in run:
        return ""
    known = run["min_gap"].isel(pair=0).dropna("time").values
    return f", gap {known[-1]:.3g} m" if len(known) else ""


def _closer(axes: Any, run: xr.Dataset, colour: str) -> None:
    """Show the place under the moving body at the end, enlarged."""
    outlines = run["outline"].sel(frame="last").values
    first = run["outline"].sel(frame="first").values
    travel = (
        np.nan_to_num(np.nanmax(np.abs(outlines - first), axis=(1, 2)))
        if np.isfinite(outlines).any()
        else [0.0]
    )
    if len(outlines) != 2 or not np.any(travel):
        return
    mover = outlines[int(np.argmax(travel))]
    lowest = mover[np.nanargmin(mover[:, 1])]
    span = 0.25 * float(np.nanmax(mover[:, 0]) - np.nanmin(mover[:, 0]))
    inset = axes.inset_axes((0.02, 0.45, 0.16, 0.5))
    for line in outlines:
        inset.plot(line[:, 0], line[:, 1], color=colour, linewidth=0.9, marker=".", markersize=2)
    inset.set_xlim(lowest[0] - span, lowest[0] + span)
    inset.set_ylim(lowest[1] - span, lowest[1] + span)
    inset.set_xticks([])
    inset.set_yticks([])
    axes.indicate_inset_zoom(inset, edgecolor="0.4", linewidth=0.6)
