"""Figure of the case: penetration, accuracy, contact stress and steps over κ."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from questions import BLUE, GREEN, ORANGE, PINK, REFERENCE

from mpmfw.plots.style import FONT, dress, new_figure

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
    _curve(errors, found, "displacement", GREEN, "s", "rolling: displacement")
    _curve(errors, found, "acceleration", BLUE, "o", "rolling: acceleration")
    _curve(errors, found, "impulse", ORANGE, "^", "rings: impulse curve")
    _curve(errors, found, "spin", PINK, "D", "rolling: spin")
    errors.set_yscale("symlog", linthresh=1.0)
    errors.axhline(0.0, color="black", linewidth=0.5)
    dress(errors, "", "error [%]", "(b) accuracy")
    _curve(limit, found, "limit", BLUE, "o", "blocks")
    limit.plot(kappas, 1.0 / np.sqrt(1.0 + kappas), **REFERENCE, label="(1 + κ)^(−1/2)")
    limit.set_yscale("log")
    dress(limit, "stiffness factor κ", "limit of the time step [h/c]", "(c) stable time step")
    fine = np.logspace(np.log10(kappas[0]), np.log10(kappas[-1]), 60)
    for name, colour, marker, label in (
        ("rolling_steps", GREEN, "s", "rolling"),
        ("rings_steps", ORANGE, "^", "rings"),
    ):
        _curve(steps, found, name, colour, marker, label)
    if "rings_steps" in found:
        scale = found["rings_steps"][1.0] / np.sqrt(2.0)
        steps.plot(fine, scale * np.sqrt(1.0 + fine), **REFERENCE, label="∝ (1 + κ)^(1/2)")
    steps.set_yscale("log")
    dress(steps, "stiffness factor κ", "steps", "(d) cost")
    for axes in (depth, errors, limit, steps):
        axes.set_xscale("log")
        axes.set_xticks([kappa for kappa in (0.01, 0.1, 1.0, 10.0, 100.0) if kappas[0] <= kappa <= kappas[-1]])
        axes.legend(fontsize=FONT - 2, frameon=False)
    return figure


def _curve(axes: Any, found: Found, name: str, colour: str, marker: str, label: str) -> None:
    if name in found:
        values = np.array(sorted(found[name].items()))
        axes.plot(*values.T, color=colour, marker=marker, markersize=3.5, linewidth=1.1, label=label)
