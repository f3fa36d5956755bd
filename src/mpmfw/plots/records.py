"""Records of many scenes and codes in one figure: errors and cost, a row for each scene."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from mpmfw.errors import SceneError
from mpmfw.plots.style import Look, dress, entry, journal_style, legend_below, new_figure

#: Least error that is drawn in its place [%].
LEAST = 0.01

_MARKERS = "osD^vPX"

#: Hash of the problem, title of its scene, cell size [m] and processor.
Row = tuple[str, str, float, str]


class Dot(NamedTuple):
    """Errors and cost of one record; NaN where it lacks one."""

    row: Row
    method: str
    code: str
    motion: float  #: error [%]
    spin: float  #: error [%]
    cpu_time: float  #: [s]


@journal_style()
def dots(found: Sequence[Dot]) -> Figure:
    """Draw a dot for each record: rows downwards, a colour for each method, a marker for each code."""
    if not found:
        raise SceneError("no record is ok: there is nothing to draw")
    rows = list(dict.fromkeys(dot.row for dot in found))
    code_of = {dot.method: dot.code for dot in found}
    methods, codes = list(code_of), list(dict.fromkeys(code_of.values()))
    colours = Look(xr.Dataset(coords={"contact": methods})).colours
    markers = dict(zip(codes, _MARKERS * len(codes), strict=False))
    figure = new_figure(3, 1, 8.0 * len(rows) + 10.0)
    panels = figure.subplots(1, 3, sharey=True)
    labels = ("error of the motion [%]", "error of the spin [%]", "CPU time [s]")
    for k, (axes, label) in enumerate(zip(panels, labels, strict=True)):
        for row, method, code, *values in found:
            beside = 0.7 * (methods.index(method) / max(len(methods) - 1, 1) - 0.5)
            value = max(values[k], LEAST) if k < 2 else values[k]
            axes.plot(value, rows.index(row) + beside, markers[code], color=colours[method], ms=4.0)
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


def _names(rows: Sequence[Row]) -> list[str]:
    """Return the names of scenes with their cell sizes; of repeated scenes the cell size alone; processors if
    several.

    Problems that share a title have their hash.
    """
    names, before, machines = [], "", {row[3] for row in rows}
    alike = Counter(scene for _, scene in {row[:2] for row in rows})
    for problem, scene, cell, machine in rows:
        size = f"h\u00a0=\u00a0{cell:g}\u00a0m" + (f", {machine}" if len(machines) > 1 else "")
        title = f"{scene} ({problem})" if alike[scene] > 1 else scene
        names.append(textwrap.fill(size if problem == before else f"{title}, {size}", 36))
        before = problem
    return names
