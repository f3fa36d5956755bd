"""Figure of the case: displacement over the time step, and acceleration over μ."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from questions import BLUE, GRAVITY, ORANGE, REFERENCE

from mpmfw.plots.style import dress, legend_below, new_figure

#: Time step [ms] and error of the displacement [%], by the fraction of the stability limit.
Curve = dict[float, tuple[float, float]]
LOOKS: dict[str, dict[str, Any]] = {
    "": {"color": BLUE, "marker": "o", "linestyle": "-", "label": "return map"},
    "literal": {"color": ORANGE, "marker": "^", "linestyle": "-", "label": "literal"},
    "viscous": {**REFERENCE, "label": "rigid, viscous friction k_t Δt"},
}


def draw(
    curves: Mapping[tuple[str, str], Curve], over_friction: Mapping[str, Mapping[float, float]]
) -> Figure:
    """A panel for each roll, and one over μ."""
    rolls = [name for name in ("no slip", "slip") if (name, "") in curves]
    count = len(rolls) + bool(over_friction)
    figure = new_figure(count, 1, 58.0)
    panels = figure.subplots(1, count, squeeze=False)[0]
    handles = {}
    for axes, roll, letter in zip(panels, rolls, "ab", strict=False):
        for label, look in LOOKS.items():
            values = np.array(sorted(curves[roll, label].values()))
            handles[label] = axes.semilogx(*values.T, markersize=3.5, **{"linewidth": 1.1, **look})[0]
        axes.axhline(0.0, color="black", linewidth=0.5)
        steps = sorted(step for step, _ in curves[roll, ""].values())
        axes.set_xticks(steps, [f"{step:.2g}" for step in steps])
        axes.set_xticks([], minor=True)
        dress(axes, "time step [ms]", "error of the displacement [%]", f"({letter}) rolling, {roll}")
    if over_friction:
        axes = panels[-1]
        _exact(axes)
        for label, values in over_friction.items():
            look = {key: value for key, value in LOOKS[label].items() if key not in ("label", "linestyle")}
            axes.plot(*np.array(sorted(values.items())).T, linestyle="", markersize=4, **look)
        axes.legend()
        dress(
            axes,
            "friction coefficient μ [–]",
            "fitted acceleration [m/s²]",
            f"({'abc'[count - 1]}) slope of 60°, several μ",
        )
    lines = [handles[label] for label in LOOKS]
    legend_below(figure, [lines] if count > 1 else [[line] for line in lines])
    return figure


def _exact(axes: Any) -> None:
    tilt = math.pi / 3.0
    friction = np.linspace(0.0, 0.8, 161)
    slips = math.sin(tilt) - friction * math.cos(tilt)
    exact = GRAVITY * np.maximum(slips, 2.0 * math.sin(tilt) / 3.0)
    axes.plot(friction, exact, color="black", linewidth=0.9, label="rigid, Coulomb")
