"""Figure of the case: errors of the four treatments at the paper's cell size, and over the cell size."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from questions import BLUE, ORANGE, REFERENCE
from rolling import lumping_loss

from mpmfw.plots.style import dress, legend_below, new_figure

LOOKS: dict[str, dict[str, Any]] = {
    "spin": {"color": "black", "marker": "D"},
    "exact": {"color": BLUE, "marker": "o"},
    "lumped": {"color": ORANGE, "marker": "^"},
}
SHORT = {
    "displacement": "displ.",
    "acceleration": "accel.",
    "spin": "spin",
    "angular acceleration": "ang. accel.",
}


def draw(found: Mapping[tuple[str, str, float], Mapping[str, list[float]]]) -> Figure:
    """A panel for each roll at the cell size of the paper, and |error| of the acceleration over h."""
    rolls = [roll for roll in ("no slip", "slip") if any(key[0] == roll for key in found)]
    paper = 0.4 if any(key[2] == 0.4 for key in found) else 0.8
    sizes = sorted({key[2] for key in found})
    count = len(rolls) + (len(sizes) > 1)
    figure = new_figure(count, 1, 58.0)
    panels = figure.subplots(1, count, squeeze=False)[0]
    for axes, roll, letter in zip(panels, rolls, "ab", strict=False):
        _measures(
            axes, {key[1]: errors for key, errors in found.items() if key[0] == roll and key[2] == paper}
        )
        dress(axes, "", "error [%]", f"({letter}) {roll}, h = {paper:g} m, each grid offset")
    if len(sizes) > 1:
        _over_size(panels[-1], found, sizes)
    handles = [
        figure.axes[0].plot([], [], linestyle="", markersize=4, label=f"rotation = {name}", **look)[0]
        for name, look in LOOKS.items()
        if any(key[1] == name for key in found)
    ]
    legend_below(figure, [handles])
    return figure


def _measures(axes: Any, found: Mapping[str, Mapping[str, list[float]]]) -> None:
    for number, (rotation, errors) in enumerate(found.items()):
        for place, name in enumerate(SHORT):
            at = place + 0.2 * (number - 1.5) + 0.05 * np.arange(len(errors[name]))
            axes.plot(at, errors[name], linestyle="", markersize=4, fillstyle="none", **LOOKS[rotation])
    axes.axhline(0.0, **REFERENCE)
    axes.set_xticks(range(len(SHORT)), list(SHORT.values()))


def _over_size(
    axes: Any, found: Mapping[tuple[str, str, float], Mapping[str, list[float]]], sizes: list[float]
) -> None:
    for rotation, look in LOOKS.items():
        own = [h for h in sizes if ("no slip", rotation, h) in found]
        errors = [abs(found["no slip", rotation, h]["acceleration"][0]) for h in own]
        axes.loglog(own, errors, markersize=4, linewidth=1.1, **look)
    h = np.array(sizes)
    axes.loglog(h, 100.0 * lumping_loss(h, 0.5 * h) / 3.0, **REFERENCE, label="ε/3 ∝ h²")
    axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
    axes.set_xticks([], minor=True)
    axes.legend()
    dress(axes, "cell size h [m]", "|error of the acceleration| [%]", "(c) no slip")
