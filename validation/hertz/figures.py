"""Figures of the Hertz contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from pressure import HALF_WIDTH, PEAK, Profile, from_forces, from_stress

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CaseRun

Profiles = Mapping[tuple[str, float], Profile]
COLOURS = ("#E69F00", "#0072B2", "#009E73", "#7F3C8D")
MARKERS = ("s", "o", "^", "D")
CLASSICAL = ("bardenhagen, cpdi", "bardenhagen, cpdi, normal given", "none, cpdi", "bardenhagen, gimp")


def _profiles(runs: Sequence[CaseRun]) -> Profiles:
    """By method and cell size [m]; of penalty contact by its forces."""
    return {
        (str(run.method), run.scene.grid.cell_size): (
            from_forces(run.results) if run.method.contact == "penalty" else from_stress(run.results)
        )
        for run in runs
    }


def pressures(runs: Sequence[CaseRun]) -> Figure:
    """Draw penalty contact at all cell sizes, and the other methods at the scene's, against Hertz."""
    profiles = _profiles(runs)
    figure = new_figure(2, 1, 66.0)
    axes = figure.subplots(1, 2, sharey=True)
    sizes = sorted({size for method, size in profiles if method == "penalty, cpdi"}, reverse=True)
    for size, colour, marker in zip(sizes, COLOURS, MARKERS, strict=False):
        label = f"b/h = {HALF_WIDTH / size:.1f}"
        _draw(axes[0], profiles["penalty, cpdi", size], colour, marker, label)
    for label, colour, marker in zip(CLASSICAL, COLOURS, MARKERS, strict=True):
        found = [profile for (method, _), profile in profiles.items() if method == label]
        if found:
            _draw(axes[1], found[0], colour, marker, label)
    for panel, title in zip(
        axes, ("(a) penalty, cpdi; forces", "(b) others, b/h = 3.0; stress at the rim"), strict=True
    ):
        x = np.linspace(-1.0, 1.0, 400)
        panel.plot(x, np.sqrt(1.0 - x**2), color="0.2", linewidth=1.0, label="Hertz")
        dress(panel, "x / b [1]", "p / p0 [1]", title)
        panel.set_xlim(-2.2, 2.2) if panel is axes[0] else panel.set_xlim(-4.0, 4.0)
        panel.set_ylim(-0.1, 2.0)
        panel.legend(loc="upper right", ncols=2 if panel is axes[0] else 1)
    return figure


def _draw(panel: Any, profile: Profile, colour: str, marker: str, label: str) -> None:
    x, p = profile.x / HALF_WIDTH, profile.pressure / PEAK
    panel.plot(x, p, color=colour, marker=marker, markersize=3, linewidth=0.8, linestyle="--", label=label)


def convergence(runs: Sequence[CaseRun]) -> Figure:
    """Draw errors of the largest pressure, of the fitted p0 and of the fitted b over the cell size."""
    profiles = _profiles(runs)
    figure = new_figure(1, 1, 68.0)
    panel = figure.subplots()
    handles: list[Any] = []
    method = "penalty, cpdi"
    sizes = sorted((size for label, size in profiles if label == method), reverse=True)
    curve = [profiles[method, size] for size in sizes]
    errors = {
        "largest pressure": [abs(p.peak_error) for p in curve],
        "p0 of the fit": [abs(p.fitted_peak_error) for p in curve],
        "b of the fit": [100 * abs(p.width_error) * p.cell_size / HALF_WIDTH for p in curve],
    }
    for (name, values), colour, marker in zip(errors.items(), COLOURS, MARKERS, strict=False):
        style: dict[str, Any] = {"color": colour, "marker": marker, "markersize": 4, "linewidth": 1.0}
        panel.loglog([HALF_WIDTH / size for size in sizes], values, **style)
        handles.append(Line2D([], [], label=name, **style))
    ends = np.array([2.0, 4.0])
    panel.loglog(ends, 8.0 * ends[0] / ends, color="0.4", linestyle="--", linewidth=0.8)
    panel.text(2.2, 6.4, "order 1", color="0.3")
    panel.axhline(10.0, color="0.6", linewidth=0.6)
    panel.set_yticks([4, 6, 10, 20], ["4", "6", "10", "20"])
    dress(panel, "cells in the half-width, b/h [1]", "error [%]")
    panel.set_xticks([2, 3, 4], ["2", "3", "4"])
    panel.minorticks_off()
    legend_below(figure, [handles])
    return figure
