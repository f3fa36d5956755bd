"""Displacement, drift and friction of a block that friction must hold.

Closed form (Coulomb): a block at rest on an incline stays at rest if tan θ ≤ μ; friction then is T = m g sin θ, so
T / N = tan θ, below μ.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.lines import Line2D

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CONTACTS, CaseRun

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

HEIGHT = 0.3  # of the block [m]
MOST_DISPLACEMENT = 1e-3  # of the height, as in case.toml


COLOURS = dict(zip(CONTACTS, ("#009E73", "#D55E00", "#117733", "#0072B2"), strict=True)) | {
    "hamad2017": "#56B4E9"
}
LITERAL = "#B2B200"
STYLES = {"linear": ":", "gimp": "--", "cpdi": "-", "cpdi2": "-.", "bspline": (0, (5, 1, 1, 1, 1, 1))}


def displacement(run: xr.DataTree) -> float:
    """Of the block's centre at the end, over its height."""
    return float(np.hypot(*_moved(run["series"].to_dataset())[-1])) / HEIGHT


def creep(run: xr.DataTree) -> dict[str, float]:
    """Largest distance of the block's centre from where it began, ``way``, and how far that changes after the first fifth of the
    time, ``later``, both in cells."""
    centre = run["series"].to_dataset()["centre_of_mass"].sel(body="block").values
    way = np.linalg.norm(centre - centre[0], axis=1) / float(run.attrs["cell_size"])
    return {"way": float(way.max()), "later": float(np.ptp(way[len(way) // 5 :]))}


def drift(run: xr.DataTree) -> float:
    """Slope of the line fitted to the way along the plane in the last second, over the height [1/s]."""
    series = run["series"].to_dataset()
    time, last = series["time"].values, _last_second(series)
    return float(np.polyfit(time[last], _moved(series)[last, 0], 1)[0]) / HEIGHT


def friction(run: xr.DataTree) -> float | None:
    """T / N in the last second; none without a contact force."""
    series = run["series"].to_dataset()
    if "contact_force" not in series:
        return None
    force = series["contact_force"].sel(pair="block-plane")[_last_second(series)].mean("time")
    return -float(force.sel(axis="x") / force.sel(axis="y"))


def _last_second(series: xr.Dataset) -> np.ndarray:
    time = series["time"].values
    return np.asarray(time >= time[-1] - 1.0)


def _moved(series: xr.Dataset) -> np.ndarray:
    """Displacement of the block's centre, (time, axis) [m]."""
    centre = series["centre_of_mass"].sel(body="block").values
    return centre - centre[0]


def draw(runs: Sequence[CaseRun]) -> Figure:
    """Magnitude of the displacement over time, logarithmic, against the limit."""
    results = {run.method: run.results["series"].to_dataset() for run in runs}
    figure = new_figure(1, 1, 78.0)
    axes = figure.subplots()
    rows: list[list[Line2D]] = [[], []]
    for method, series in results.items():
        literal = method.label == "literal"
        if method.label and not literal:
            continue
        look = {
            "color": LITERAL if literal else COLOURS[method.contact],
            "linestyle": STYLES[method.shape],
            "linewidth": 1.1,
        }
        size = np.hypot(*_moved(series).T) / HEIGHT
        axes.semilogy(series["time"].values[1:], np.maximum(size[1:], 1e-12), **look)
    axes.axhline(MOST_DISPLACEMENT, color="k", linewidth=1.0)
    axes.annotate("limit", (0.5, MOST_DISPLACEMENT), xytext=(0, 2), textcoords="offset points")
    axes.set_ylim(1e-10, 1.0)
    dress(axes, "time [s]", "displacement / height [–]")
    contacts = {m.contact for m in results}
    rows[0] = [
        Line2D([], [], color=colour, linewidth=2.5, label=name)
        for name, colour in COLOURS.items()
        if name in contacts
    ]
    if any(m.label == "literal" for m in results):
        rows[0].append(Line2D([], [], color=LITERAL, linewidth=2.5, label="hamad2017, literal"))
    shapes = [
        Line2D([], [], color="0.3", linestyle=style, linewidth=1.1, label=name)
        for name, style in STYLES.items()
        if name in {m.shape for m in results}
    ]
    rows = [line[k : k + 3] for line in (rows[0], shapes) for k in range(0, len(line), 3)]
    legend_below(figure, rows)
    return figure
