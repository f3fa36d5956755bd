"""Records of many scenes and codes in one figure: errors and cost, a row for each scene."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from mpmfw.plots.style import Look, dress, entry, journal_style, legend_below, new_figure

#: Least error that is drawn in its place [%].
LEAST = 0.01

_MARKERS = "osD^vPX"

#: Scene, cell size [m], method, code, and its errors of motion and spin [%] and CPU time [s], or NaN.
Dot = tuple[str, float, str, str, float, float, float]


@journal_style()
def dots(found: Sequence[Dot]) -> Figure:
    """Draw a dot for each record: scenes downwards, a colour for each method, a marker for each code."""
    rows = list(dict.fromkeys(dot[:2] for dot in found))
    code_of = {dot[2]: dot[3] for dot in found}
    methods, codes = list(code_of), list(dict.fromkeys(code_of.values()))
    colours = Look(xr.Dataset(coords={"contact": methods})).colours
    markers = dict(zip(codes, _MARKERS * len(codes), strict=False))
    figure = new_figure(3, 1, 8.0 * len(rows) + 10.0)
    panels = figure.subplots(1, 3, sharey=True)
    labels = ("error of the motion [%]", "error of the spin [%]", "CPU time [s]")
    for k, (axes, label) in enumerate(zip(panels, labels, strict=True)):
        for scene, cell, method, code, *values in found:
            beside = 0.7 * (methods.index(method) / max(len(methods) - 1, 1) - 0.5)
            value = max(values[k], LEAST) if k < 2 else values[k]
            axes.plot(value, rows.index((scene, cell)) + beside, markers[code], color=colours[method], ms=4.0)
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(numticks=6))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        for edge in np.arange(0.5, len(rows) - 1):
            axes.axhline(edge, color="0.8", linewidth=0.5)
        dress(axes, label, "")
        axes.grid(visible=False, axis="y")
    panels[0].set_yticks(range(len(rows)), _names(rows))
    panels[0].set_ylim(len(rows) - 0.5, -0.5)
    key = [
        entry(name, color=colours[name], marker=markers[code_of[name]], linestyle="", ms=5.0)
        for name in methods
    ]
    legend_below(figure, [key])
    return figure


def _names(rows: Sequence[tuple[str, float]]) -> list[str]:
    """Return each scene with its cell size; where scenes repeat, the cell size alone."""
    names, before = [], ""
    for scene, cell in rows:
        size = f"h\u00a0=\u00a0{cell:g}\u00a0m"
        names.append(size if scene == before else textwrap.fill(f"{scene}, {size}", 36))
        before = scene
    return names
