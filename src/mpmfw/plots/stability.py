"""The map of stability: classes of runs over stiffness and time step."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from mpmfw.plots.style import dress, journal_style, legend_below, new_figure
from mpmfw.state.fields import FloatArray

#: Colours of the classes in their order; they differ in lightness too.
COLOURS = ("#F2F2F2", "#9BD0E8", "#E69F00", "#8C1515")
_LABELS = {"kappa": "stiffness factor κ [–]", "ratio": "stiffness of the second body / first [–]"}


def stability_figures(dataset: xr.Dataset) -> dict[str, tuple[Figure, str]]:
    """Return the figure of a map: ``{name: (figure, caption)}``."""
    caption = (
        f"Runs of {dataset.attrs['steps_asked']} steps: {dataset.attrs['bounds']}. Line: closed form. "
        "Circles: Gershgorin's bound. Dashes: Courant number past which a step is refused."
    )
    return {"stability": (stability_chart(dataset), caption)}


@journal_style()
def stability_chart(dataset: xr.Dataset) -> Figure:
    """Draw the classes of a map over stiffness and Courant number, both logarithmic."""
    axis = str(dataset["class"].dims[0])
    names = dataset.attrs["classes"].split(", ")
    x, y = (np.sort(dataset[name].values.astype(float)) for name in (axis, "cfl"))
    figure = new_figure(1, 1, 64.0)
    axes: Any = figure.subplots()
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.pcolormesh(
        _edges(x),
        _edges(y),
        np.ma.masked_less(dataset["class"].sortby([axis, "cfl"]).transpose("cfl", axis).values, 0),
        cmap=ListedColormap(COLOURS),
        norm=BoundaryNorm(np.arange(len(COLOURS) + 1) - 0.5, len(COLOURS)),
        edgecolors="white",
        linewidth=0.6,
    )
    _draw_limits(axes, dataset.sortby(axis), axis)
    axes.set_xlim(*_edges(x)[[0, -1]])
    axes.set_ylim(*_edges(y)[[0, -1]])
    title = f"{dataset.attrs['contact']}, {dataset.attrs['shape']}"
    dress(axes, _LABELS[axis], "Courant number c Δt / h [–]", title)
    axes.grid(False)
    _ticks(axes.xaxis, x)
    _ticks(axes.yaxis, y)
    met = np.unique(dataset["class"].values)
    patches = [Patch(facecolor=COLOURS[k], edgecolor="0.6", linewidth=0.4, label=names[k]) for k in met]
    legend_below(figure, [patches, axes.get_legend_handles_labels()[0]])
    return figure


def _edges(values: FloatArray) -> FloatArray:
    logs = np.log(values)
    half = 0.5 * np.diff(logs) if len(logs) > 1 else np.array([0.35])
    return np.asarray(np.exp([logs[0] - half[0], *(logs[:-1] + half[: len(logs) - 1]), logs[-1] + half[-1]]))


def _draw_limits(axes: Any, dataset: xr.Dataset, axis: str) -> None:
    x = dataset[axis].values.astype(float)
    axes.plot(x, dataset["closed_form"].values, color="white", linewidth=2.8)
    axes.plot(x, dataset["closed_form"].values, color="black", linewidth=1.2, label="closed form")
    look = {"markerfacecolor": "white", "markeredgecolor": "black", "markeredgewidth": 0.9, "markersize": 4.0}
    axes.plot(x, dataset["limit"].values, linestyle="", marker="o", label="Gershgorin bound", **look)
    if "courant" in dataset.attrs:
        courant, dashes = float(dataset.attrs["courant"]), (0, (4, 2))
        axes.axhline(courant, color="black", linewidth=0.8, linestyle=dashes, label="refused")


def _ticks(axis: Any, values: FloatArray) -> None:
    every = 1 + (len(values) - 1) // 10
    axis.set_major_locator(FixedLocator(list(values[::every])))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
