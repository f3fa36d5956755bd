"""The contact force of the colliding rings beside the finite-element reference ([H17] figure 4)."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpmfw.plots.style import (
    Look,
    combinations,
    drawn_reference,
    dress,
    head,
    journal_style,
    legend_below,
    new_figure,
)
from mpmfw.results import analysis
from mpmfw.results.references import RingsReference, rings_table
from mpmfw.state.fields import FloatArray

WINDOW = 100e-6  #: of the averaged panel [s]

_EXACT: dict[str, Any] = {"color": "black", "linewidth": 1.0, "zorder": 5}


@journal_style()
def contact_force(dataset: xr.Dataset) -> Figure:
    """Contact force over time as stored and averaged over 100 µs, and its impulse, beside the reference.

    Parameters
    ----------
    dataset
        Comparison; the reference is drawn if the scene is the one it was computed for. Methods that report no
        contact force, such as ``none``, are left out.
    """
    figure = new_figure(2, 2, 52.0)
    head(figure, dataset)
    panels = figure.subplot_mosaic([["raw", "raw"], ["mean", "impulse"]])
    look, time = Look(dataset), dataset["time"].values
    drawn = []
    for turn, (contact, shape, run) in enumerate(combinations(dataset)):
        force = -run["contact_force"].isel(pair=0).sel(axis="x").values  # on the pair's second body
        if not np.isfinite(force).any():
            continue
        drawn.append((contact, shape))
        line = look.line(contact, shape, len(time), turn)
        thin = {**line, "marker": "", "linewidth": 0.5, "linestyle": "-", "alpha": 0.6}
        panels["raw"].plot(1e3 * time, 1e-3 * force, **thin)
        mean = analysis.running_average(time, force, WINDOW)
        panels["mean"].plot(1e3 * time, 1e-3 * mean, **line)
        panels["impulse"].plot(1e3 * time, analysis.impulse(time, force), **line)
    rows = look.key({contact for contact, _ in drawn}, {shape for _, shape in drawn})
    if isinstance(drawn_reference(dataset), RingsReference):
        rows[0].insert(0, _draw_reference(panels, time))
    dress(panels["raw"], "time [ms]", "force [kN/m]", "contact force, mean over each output interval")
    dress(panels["mean"], "time [ms]", "force [kN/m]", "contact force, mean over 100 µs")
    dress(panels["impulse"], "time [ms]", "impulse [N s/m]", "impulse")
    legend_below(figure, rows)
    return figure


def _draw_reference(panels: dict[str, Any], time: FloatArray) -> Artist:
    reference = rings_table("force")
    inside = reference["time"] <= time[-1]
    at, impulse = 1e3 * reference["time"][inside], reference["fine_impulse_Ns_per_m"]
    exact = analysis.averaged(reference["time"], impulse, WINDOW)
    panels["raw"].plot(at, 1e-3 * reference["fine_force_raw_N_per_m"][inside], **{**_EXACT, "linewidth": 0.6})
    panels["mean"].plot(at, 1e-3 * exact[inside], **_EXACT)
    panels["impulse"].plot(at, impulse[inside], **_EXACT)
    return Line2D([], [], color="black", linewidth=1.0, label="finite elements, 0.5 mm")
