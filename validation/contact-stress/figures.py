"""Figure of the contact stress."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from blocks import stress
from matplotlib.figure import Figure

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CaseRun

COLOURS = ("#0072B2", "#56B4E9", "#D55E00", "#E69F00")


def convergence(runs: Sequence[CaseRun]) -> Figure:
    """Draw L2 error and departure away from the walls over the cell size, with slopes for reference."""
    curves: dict[str, list[tuple[float, dict[str, float]]]] = {}
    for run in runs:
        found = float(run.results.attrs["cell_size"]), stress(run.results)
        curves.setdefault(str(run.method), []).append(found)
    figure = new_figure(2, 1, 62.0)
    left, right = figure.subplots(1, 2)
    handles = []
    for (label, curve), colour, marker in zip(curves.items(), COLOURS, "oDs^", strict=False):
        h = [size for size, _ in curve]
        style: dict[str, Any] = {"color": colour, "marker": marker, "markersize": 3.5, "linewidth": 1.1}
        handles += left.loglog(h, [errors["l2"] for _, errors in curve], label=label, **style)
        right.loglog(h, [errors["off the walls"] for _, errors in curve], **style)
    first = next(iter(curves.values()))
    sizes, error = np.array([size for size, _ in first]), first[0][1]["l2"]
    left.loglog(sizes, 0.6 * error * np.sqrt(sizes / sizes[0]), color="0.4", linestyle="--", linewidth=0.8)
    left.annotate("order 1/2", (sizes[1], 0.42 * error), (-14, 5), textcoords="offset points", color="0.3")
    right.axhline(3.0, color="0.4", linestyle="--", linewidth=0.8)
    right.annotate("limit, 3 %", (sizes[-1], 3.0), (0, -4), textcoords="offset points", color="0.3", va="top")
    dress(left, "cell size h [m]", "L2 error of σ_yy, both blocks [%]", "(a)")
    dress(right, "cell size h [m]", "largest departure off the walls [%]", "(b)")
    for panel in (left, right):
        panel.set_xticks(sizes, [f"{size:g}" for size in sizes])
        panel.minorticks_off()
    legend_below(figure, [handles])
    return figure
