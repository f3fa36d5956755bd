"""Figure of the Hertz contact."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from pressure import HALF_WIDTH, by_size

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CaseRun


def convergence(runs: Sequence[CaseRun]) -> Figure:
    """Draw errors of the largest pressure, of the fitted p0 and of the fitted b over the cell size."""
    errors = by_size(runs)
    curves = (
        ("largest pressure", errors["peak"], "#E69F00", "s"),
        ("p0 of the fit", errors["fitted peak"], "#0072B2", "o"),
        ("b of the fit", 100.0 * errors["width"] / HALF_WIDTH, "#009E73", "^"),
    )
    figure = new_figure(1, 1, 68.0)
    panel = figure.subplots()
    handles = []
    for name, values, colour, marker in curves:
        style = {"color": colour, "marker": marker, "markersize": 4, "linewidth": 1.0}
        handles += panel.loglog(HALF_WIDTH / errors["h"], values, label=name, **style)
    ends = np.array([2.0, 4.0])
    panel.loglog(ends, 8.0 * ends[0] / ends, color="0.4", linestyle="--", linewidth=0.8)
    panel.annotate("order 1", (3.3, 16.0 / 3.3), (0, 4), textcoords="offset points", color="0.3")
    panel.set_yticks(ticks := [0.2, 0.5, 1, 2, 5, 10], [f"{tick:g}" for tick in ticks])
    dress(panel, "cells in the half-width, b/h [1]", "error [%]")
    panel.set_xticks([2, 3, 4], ["2", "3", "4"])
    panel.minorticks_off()
    legend_below(figure, [handles])
    return figure
