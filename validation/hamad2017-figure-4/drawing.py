"""Finite elements of the resolution of [H17], and the figure of the case."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from rings import force_of, reference_impulse, series_of

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.results.analysis import averaged, impulse
from mpmfw.validation import CaseRun

sys.path.insert(0, str(Path(__file__).parents[1] / "finite-elements"))
from rings_fem import collide

INTERVAL = 5e-6  #: over which every force that is called raw is a mean: the runs' outputs [s]
FINE: dict[str, Any] = {"color": "black", "linewidth": 1.3, "label": "finite elements, 9-node, 0.5 mm"}
COARSE: dict[str, Any] = {
    "color": "0.55",
    "linewidth": 1.0,
    "linestyle": (0, (4, 1.5)),
    "label": "finite elements, 4-node, 2 mm",
}
#: Of penalty with CPDI, by label of the method.
LOOKS: dict[str, dict[str, Any]] = {
    "": {"color": "#0072B2", "linewidth": 1.0, "label": "penalty, CPDI, κ = 0.25"},
    "kappa 1": {"color": "#D55E00", "linewidth": 0.9, "linestyle": (0, (3, 1, 1, 1)), "label": "κ = 1"},
    "cells 1 mm": {
        "color": "#009E73",
        "linewidth": 0.9,
        "linestyle": (0, (1, 1)),
        "label": "κ = 0.25, cells of 1 mm",
    },
}


def forces(runs: Sequence[CaseRun]) -> Figure:
    """[H17] fig. 4: the force as it comes, and averaged over 50, 100 and 200 µs."""
    figure = new_figure(2, 2, 55.0)
    panels = figure.subplots(2, 2, sharex=True)
    drawn = {
        run.method.label: force_of(series_of(run.results))
        for run in runs
        if run.method.contact == "penalty" and run.method.shape == "cpdi" and run.method.label in LOOKS
    }
    time, _ = next(iter(drawn.values()))
    elements = np.interp(time, collide(2e-3).time, collide(2e-3).impulse)
    windows = zip(
        panels.flat, (INTERVAL, 50e-6, 100e-6, 200e-6), ("(a) raw,", "(b)", "(c)", "(d)"), strict=True
    )
    for axes, window, name in windows:
        for label, (times, force) in drawn.items():
            if window > INTERVAL or not label:
                mean = force if window == INTERVAL else averaged(times, impulse(times, force), window)
                axes.plot(1e3 * times, 1e-3 * mean, **LOOKS[label], zorder=3 if not label else 2)
        axes.plot(1e3 * time, 1e-3 * averaged(time, reference_impulse(time), window), **FINE, zorder=2.5)
        if window > INTERVAL:
            axes.plot(1e3 * time, 1e-3 * averaged(time, elements, window), **COARSE)
        below = "time [ms]" if axes in panels[1] else ""
        dress(axes, below, "force [kN/m]", f"{name} mean over {1e6 * window:.0f} µs")
        axes.set_xlim(0.0, 3.2)
    keys = [[FINE, COARSE], [LOOKS[label] for label in LOOKS if label in drawn]]
    legend_below(figure, [[Line2D([], [], **look) for look in row] for row in keys])
    return figure
