"""Figure of the case: accuracy, noise, contact stress and cost over the length of a segment."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from questions import BLUE, GREEN, GREY, ORANGE, PINK, REFERENCE

from mpmfw.plots.style import dress, new_figure

#: Values by name and length of a segment [h].
Found = dict[str, dict[float, float]]
SIZES = {0.125: "h/8", 0.25: "h/4", 0.5: "h/2", 1.0: "h", 2.0: "2h"}


def draw(found: Found) -> Figure:
    """Four panels over a logarithmic axis."""
    figure = new_figure(2, 2, 52.0)
    (motion, force), (stress, cost) = figure.subplots(2, 2)
    _curve(motion, found, "displacement", BLUE, "o", "rolling: displacement")
    _curve(motion, found, "acceleration", GREEN, "s", "rolling: acceleration")
    _curve(motion, found, "spin", PINK, "D", "rolling: spin")
    _curve(motion, found, "impulse", ORANGE, "^", "rings: impulse curve, κ = 0.25")
    _curve(motion, found, "stiff_impulse", GREY, "v", "the same, κ = 1")
    motion.set_ylim(top=9.0)
    motion.axhline(0.0, **REFERENCE)
    dress(motion, "", "error [%]", "(a) accuracy")
    _curve(force, found, "rolling_noise", BLUE, "o", "rolling")
    _curve(force, found, "rings_noise", ORANGE, "^", "rings, κ = 0.25")
    _curve(force, found, "stiff_noise", GREY, "v", "rings, κ = 1")
    force.set_yscale("log")
    force.set_ylim(1.5, 120.0)
    force.set_yticks([2, 5, 10, 20, 50, 100], ["2", "5", "10", "20", "50", "100"])
    force.set_yticks([], minor=True)
    dress(force, "", "noise of the force [%]", "(b) force")
    _curve(stress, found, "stress", BLUE, "o", "h times a power of two")
    _curve(stress, found, "stress_between", ORANGE, "D", "lengths between", linestyle="")
    stress.axhline(3.0, **REFERENCE, label="limit of 3 %")
    stress.set_yscale("log")
    dress(stress, "length of a segment", "departure of σ_yy [%]", "(c) blocks: static contact stress")
    for name, colour, marker, label in (
        ("rolling_step", BLUE, "o", "rolling"),
        ("rings_step", ORANGE, "^", "rings"),
    ):
        _curve(cost, found, name, colour, marker, label)
    cost.set_ylim(bottom=0.0)
    dress(cost, "length of a segment", "CPU time of a step [ms]", "(d) cost")
    for axes in (motion, force, stress, cost):
        axes.set_xscale("log")
        drawn = {size for curve in found.values() for size in curve}
        axes.set_xticks(*zip(*((size, name) for size, name in SIZES.items() if size in drawn), strict=True))
        axes.set_xticks([], minor=True)
        axes.legend()
    return figure


def _curve(axes: Any, found: Found, name: str, colour: str, marker: str, label: str, **look: Any) -> None:
    if name in found:
        values = np.array(sorted(found[name].items()))
        given = {"color": colour, "marker": marker, "markersize": 3.5, "linewidth": 1.1, **look}
        axes.plot(*values.T, **given, label=label)
