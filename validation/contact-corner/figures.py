"""Figures of the free expansion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from expansion import PLACES, SLOPE, Expansion, expansion_of
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpmfw.plots.style import dress, legend_below, new_figure

if TYPE_CHECKING:
    from mpmfw.validation import CaseRun

LOOKS = {
    "penalty, cpdi": ("#0072B2", "-", "o"),
    "penalty, bspline": ("#56B4E9", "-.", "v"),
    "bardenhagen, cpdi": ("#D55E00", "-", "s"),
    "bardenhagen, cpdi, stiffer body's normal": ("#E69F00", "--", "^"),
    "none, cpdi": ("#009E73", ":", "D"),
}


def methods(runs: Sequence[CaseRun]) -> Figure:
    """Expansion of every method."""
    return expansion_figure({str(run.method): expansion_of(run.results) for run in runs})


def sizes(runs: Sequence[CaseRun]) -> Figure:
    """Errors of penalty contact with CPDI over cell size and place, by both."""
    own = [run for run in runs if str(run.method) == "penalty, cpdi"]
    return size_figure({(run.scene.grid.cell_size, run.place.at): expansion_of(run.results) for run in own})


def expansion_figure(results: Mapping[str, Expansion]) -> Figure:
    """Displacement of the corners over the strain, and of the whole side at the end."""
    figure = new_figure(2, 1, 64.0)
    axes = figure.subplots(1, 2)
    handles = [Line2D([], [], color="0.2", linewidth=1.0, label="closed form")]
    for label, (colour, line, marker) in LOOKS.items():
        if label not in results:
            continue
        found = results[label]
        corner = 0.5e6 * (found.at(0.0) + found.at(1.0))
        style = {"color": colour, "linestyle": line, "marker": marker, "markersize": 3, "linewidth": 1.1}
        axes[0].plot(100 * found.strain, corner, markevery=8, **style)
        axes[1].plot(found.profile, found.height, markevery=max(1, len(found.height) // 10), **style)
        handles.append(Line2D([], [], label=label, **style))
    strain = np.array([0.0, 0.02])
    axes[0].plot(100 * strain, 1e6 * SLOPE * strain, color="0.2", linewidth=1.0)
    axes[1].axvline(1.0, color="0.2", linewidth=1.0)
    axes[1].axvspan(0.95, 1.05, color="0.9", zorder=0)
    dress(axes[0], "strain of the block ε [%]", "outward displacement, corners [µm]", "(a)")
    dress(
        axes[1],
        "u / (ν W ε / 2 (1 − ν)) [1]",
        "height over that of the block [1]",
        "(b) side, at the end; band: ± 5 %",
    )
    legend_below(figure, [handles[:3], handles[3:]])
    return figure


def size_figure(found: Mapping[tuple[float, str], Expansion]) -> Figure:
    """Errors of the slopes over the cell size, for all places of the side within a cell."""
    figure = new_figure(1, 1, 62.0)
    panel = figure.subplots()
    panel.axhspan(-5.0, 5.0, color="0.9", zorder=0)
    panel.axhline(0.0, color="0.3", linewidth=0.8)
    handles = []
    for (name, height), colour, marker in zip(
        PLACES.items(), ("#009E73", "#0072B2", "#D55E00"), "Do^", strict=True
    ):
        sizes = [1e3 * size for size, _ in found]
        errors = [run.slope_error(height) for run in found.values()]
        style = {
            "color": colour,
            "marker": marker,
            "markersize": 4,
            "linestyle": "",
            "markerfacecolor": "none",
        }
        panel.plot(sizes, errors, **style)
        handles.append(Line2D([], [], label=name, **style))
    dress(panel, "cell size h [mm]", "error of the slope [%]")
    panel.text(0.97, 0.04, "band: ± 5 %", transform=panel.transAxes, ha="right", color="0.3")
    panel.set_xlim(0.4, 1.1)
    legend_below(figure, [handles])
    return figure
