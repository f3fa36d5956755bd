"""Figures of the contact stress."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from measures import Points, points_of

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CaseRun

#: Panels: title, range of the ordinate, and the methods with their look.
PANELS: tuple[tuple[str, tuple[float, float], tuple[str, ...]], ...] = (
    (
        "(a) penalty",
        (0.8, 1.2),
        ("penalty, cpdi", "penalty, cpdi2", "penalty, cpdi, unlike points and segments"),
    ),
    (
        "(b) penalty, wrong map, and others",
        (-0.5, 2.5),
        ("penalty, cpdi, wrong map", "penalty, gimp", "penalty, bspline"),
    ),
    (
        "(c) classical, normals averaged",
        (-0.5, 2.5),
        ("bardenhagen, cpdi", "bardenhagen, gimp", "bardenhagen, bspline"),
    ),
    (
        "(d) classical, strongest form, and none",
        (0.8, 1.2),
        ("bardenhagen, cpdi, normal given", "bardenhagen, gimp, normal given", "none, cpdi"),
    ),
)
COLOURS = ("#0072B2", "#D55E00", "#009E73")
MARKERS = ("o", "s", "^")


def interface(runs: Sequence[CaseRun]) -> Figure:
    """Draw σ_yy / (−p) of the points nearest to the interface, lower block filled, upper block open."""
    results = {str(run.method): points_of(run.results) for run in reversed(runs)}
    figure = new_figure(2, 2, 62.0)
    axes = figure.subplots(2, 2).ravel()
    for panel, (title, limits, labels) in zip(axes, PANELS, strict=True):
        panel.axhline(1.0, color="0.2", linewidth=0.8)
        panel.axhspan(0.97, 1.03, color="0.88", zorder=0)
        for label, colour, marker in zip(labels, COLOURS, MARKERS, strict=True):
            if label in results:
                _rows(panel, results[label], label, colour, marker)
        dress(panel, "x [m]", "σ_yy / (−p) [1]", title)
        panel.set_ylim(*limits)
        panel.legend(loc="lower center")
    block: dict[str, Any] = {"color": "0.3", "marker": "o", "markersize": 3.5, "linewidth": 0.9}
    handles = [
        Line2D([], [], **block, label="lower block"),
        Line2D([], [], **block, linestyle=":", mfc="w", label="upper block"),
        Line2D([], [], color="0.2", linewidth=0.8, label="closed form"),
        Line2D([], [], color="0.88", linewidth=6, label="± 3 %"),
    ]
    legend_below(figure, [handles])
    return figure


def _rows(panel: Any, points: Points, label: str, colour: str, marker: str) -> None:
    for upper in (False, True):
        x, ratio = points.row(upper)
        panel.plot(
            x,
            ratio,
            color=colour,
            marker=marker,
            markersize=2.5,
            linewidth=0.8,
            linestyle=":" if upper else "-",
            markerfacecolor="w" if upper else colour,
            label=None if upper else label,
        )


def convergence(runs: Sequence[CaseRun]) -> Figure:
    """Draw L2 error and departure away from the walls over the cell size, with slopes for reference."""
    curves: dict[str, list[Points]] = {}
    for run in runs:
        curves.setdefault(str(run.method), []).append(points_of(run.results))
    figure = new_figure(2, 1, 62.0)
    axes = figure.subplots(1, 2)
    looks = zip(curves.items(), ("#0072B2", "#56B4E9", "#D55E00", "#E69F00"), "oDs^", strict=False)
    handles = []
    for (label, curve), colour, marker in looks:
        h = [points.cell_size for points in curve]
        style: dict[str, Any] = {"color": colour, "marker": marker, "markersize": 3.5, "linewidth": 1.1}
        axes[0].loglog(h, [points.l2_error for points in curve], **style)
        axes[1].loglog(h, [points.oscillation(margin=2.0) for points in curve], **style)
        handles.append(Line2D([], [], label=label, **style))
    sizes = np.array([points.cell_size for points in next(iter(curves.values()))])
    first = next(iter(curves.values()))[0].l2_error
    axes[0].loglog(sizes, 0.6 * first * np.sqrt(sizes / sizes[0]), color="0.4", linestyle="--", linewidth=0.8)
    axes[0].text(sizes[1], 0.35 * first, "order 1/2", color="0.3")
    axes[1].axhline(3.0, color="0.4", linestyle="--", linewidth=0.8)
    axes[1].text(sizes[-1], 2.6, "limit, 3 %", color="0.3")
    dress(axes[0], "cell size h [m]", "L2 error of σ_yy, both blocks [%]", "(a)")
    dress(axes[1], "cell size h [m]", "largest departure off the walls [%]", "(b)")
    for panel in axes:
        panel.set_xticks(sizes, [f"{size:g}" for size in sizes])
        panel.minorticks_off()
    legend_below(figure, [handles])
    return figure
