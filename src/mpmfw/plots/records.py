"""Rankings: data profiles of studies; errors and costs of the records of many scenes and codes."""

from __future__ import annotations

import math
import textwrap
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from mpmfw.errors import SceneError
from mpmfw.plots.style import Look, dress, entry, journal_style, legend_below, new_figure, new_panels
from mpmfw.state.fields import FloatArray

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


@journal_style()
def profiles(ranking: xr.Dataset) -> Figure:
    """Draw the share of problems over the cost, a panel for each quantity."""
    quantities = [
        name
        for name in ranking["quantity"].values.tolist()
        if ranking["over_best"].sel(quantity=name).notnull().any()
    ]
    by = ranking.attrs["by"]
    methods = [str(name) for name in ranking[by].values]
    look = Look(ranking if by == "contact" else ranking.rename({by: "contact"}))
    columns = math.ceil(len(quantities) / math.ceil(len(quantities) / 3))
    figure, panels = new_panels(len(quantities), 58.0, columns, sharey=True)
    farthest = float(ranking["over_best"].max())
    end = 1.3 * max(farthest, 2.0)
    for axes, quantity in zip(panels, quantities, strict=True):
        for name in methods:
            ratio, share = profile(ranking, quantity, name)
            x, y = np.concatenate([[1.0], ratio, [end]]), np.concatenate([[0.0], share, share[-1:]])
            axes.step(x[: len(y)], 100.0 * y, where="post", color=look.colours[name], linewidth=1.3)
        axes.set_xscale("log")
        axes.set_xlim(0.95, end)
        axes.set_ylim(0.0, 102.0)
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 5.0)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        ylabel = "problems and levels solved [%]" if axes in panels[::columns] else ""
        unit = str(ranking["unit"].sel(quantity=quantity).item())
        title = quantity if unit == "%" else f"{quantity}, levels in {unit}"
        dress(axes, "CPU time over the cheapest method's", ylabel, title)
    order = sorted(methods, key=lambda name: -len(profile(ranking, quantities[0], name)[0]))
    key = [entry(name, color=look.colours[name], linewidth=2.5) for name in order]
    legend_below(figure, [key])
    return figure


def profile(ranking: xr.Dataset, quantity: str, method: str) -> tuple[FloatArray, FloatArray]:
    """Return rising costs over the best (n,), and the share of problems solved within each.

    Source: E. D. Dolan, J. J. Moré (2002), *Mathematical Programming* 91, 201-213.
    """
    by = ranking.attrs["by"]
    ratio = ranking["over_best"].sel({"quantity": quantity, by: method}).values.ravel()
    solved = np.isfinite(ranking["over_best"].sel(quantity=quantity).values).any(axis=-1)
    solvable = solved[ranking["ran"].sel({by: method}).values].sum()
    known = np.sort(ratio[np.isfinite(ratio)])
    return known, np.arange(1, len(known) + 1) / max(int(solvable), 1)
