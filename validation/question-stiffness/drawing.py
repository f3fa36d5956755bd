"""Figure of the case: penetration, accuracy, contact stress and steps over κ."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from questions import BLUE, GREEN, ORANGE, PINK, REFERENCE

from mpmfw.plots.style import dress, new_figure

#: Values by name and κ.
Found = dict[str, dict[float, float]]


def draw(found: Found, strain: float) -> Figure:
    """Four panels; ``strain`` is p/M of the two blocks."""
    figure = new_figure(2, 2, 54.0)
    (depth, errors), (limit, steps) = figure.subplots(2, 2)
    kappas = np.array(sorted(found["depth"]))
    _curve(depth, found, "depth", BLUE, "o", "blocks at rest")
    _curve(depth, found, "rolling_depth", GREEN, "s", "rolling, mean")
    _curve(depth, found, "rings_depth", ORANGE, "^", "rings, largest")
    depth.plot(kappas, strain / kappas, **REFERENCE, label="p/(κ M), blocks")
    depth.set_yscale("log")
    dress(depth, "", "penetration [h]", "(a) penetration")
    _accuracy(errors, found)
    _curve(limit, found, "limit", BLUE, "o", "blocks")
    limit.plot(kappas, 1.0 / np.sqrt(1.0 + kappas), **REFERENCE, label="(1 + κ)^(−1/2)")
    limit.set_yscale("log")
    limit.set_ylim(0.08, 1.3)
    limit.set_yticks([0.1, 0.2, 0.5, 1.0], ["0.1", "0.2", "0.5", "1"])
    limit.set_yticks([], minor=True)
    dress(limit, "stiffness factor κ", "limit of the time step [h/c]", "(c) stable time step")
    _cost(steps, found)
    for axes in (depth, errors, limit, steps):
        axes.set_xscale("log")
        axes.set_xlim(0.008, 125.0)
        axes.set_xticks([0.01, 0.1, 1, 10, 100], ["0.01", "0.1", "1", "10", "100"])
        axes.set_xticks([], minor=True)
        if axes.get_legend_handles_labels()[0]:
            axes.legend()
    if "displacement" not in found:  # the quick version has the blocks alone
        errors.remove()
        steps.remove()
    return figure


def _accuracy(axes: Any, found: Found) -> None:
    _curve(axes, found, "displacement", GREEN, "s", "rolling: displacement")
    _curve(axes, found, "acceleration", BLUE, "o", "rolling: acceleration")
    _curve(axes, found, "spin", PINK, "D", "rolling: spin")
    _curve(axes, found, "impulse", ORANGE, "^", "rings: impulse curve")
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_ylim(-10.0, 3e3)  # room for the legend
    axes.set_yticks([-10, -1, 0, 1, 10, 100], ["−10", "−1", "0", "1", "10", "100"])
    axes.axhline(0.0, color="black", linewidth=0.5)
    dress(axes, "", "error [%]", "(b) accuracy")


def _cost(axes: Any, found: Found) -> None:
    _curve(axes, found, "rolling_steps", GREEN, "s", "rolling")
    _curve(axes, found, "rings_steps", ORANGE, "^", "rings")
    if "rings_steps" in found:
        kappas = np.logspace(-2.0, 2.0, 60)
        scale = found["rings_steps"][10.0] / np.sqrt(11.0)
        axes.plot(kappas, scale * np.sqrt(1.0 + kappas), **REFERENCE, label="rings, ∝ (1 + κ)^(1/2)")
    axes.set_yscale("log")
    axes.set_ylim(1e3, 4e4)
    axes.set_yticks([1000, 2000, 5000, 10000, 20000], ["1000", "2000", "5000", "10 000", "20 000"])
    axes.set_yticks([], minor=True)
    dress(axes, "stiffness factor κ", "steps", "(d) cost")


def _curve(axes: Any, found: Found, name: str, colour: str, marker: str, label: str) -> None:
    if name in found:
        values = np.array(sorted(found[name].items()))
        axes.plot(*values.T, color=colour, marker=marker, markersize=3.5, linewidth=1.1, label=label)
