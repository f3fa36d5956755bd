"""Domains and surfaces of the cylinder at the start and at the end, counted and drawn."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from rolling import BODY, motion_of

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CLASSICAL, CaseRun, Method

_COLOURS = {"penalty": "#0072B2", **dict(zip(CLASSICAL, ("#D55E00", "#117733"), strict=True))}
_GREY = {"plane": "0.85", BODY: "0.93"}
_SHADE = 0.35  #: of the marked quarter
_HEIGHTS = (32.0, 46.0, 46.0)  #: of the panels [mm]
_ZOOM = (2.1, 0.9)  #: size of the enlarged window [m]
_TOP = 0.8  #: of the plane [m]
_CELLS: dict[str, Any] = {"color": "#117733", "linewidth": 0.7, "linestyle": (0, (4, 3)), "zorder": 1.5}


def counted(runs: Sequence[CaseRun]) -> dict[str, float]:
    """Return ``segments`` of both surfaces, each body's ``points`` and its longest ``edge`` [m]."""
    tree = next(run.results for run in runs if run.method.recommended)
    found = {
        "segments": float(sum(group.sizes["surface_node"] for group in tree["surface"].children.values()))
    }
    for body, group in tree["particles"].children.items():
        corners = np.asarray(group["corners"].isel(time=0))
        edge = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max()
        found |= {f"points {body}": float(len(corners)), f"edge {body}": float(edge)}
    return found


def draw(every: Sequence[CaseRun]) -> Figure:
    """Draw a column for each method: the plane, and where the bodies meet at the start and at the end."""
    runs = {run.method: run.results for run in every if not run.method.label}
    figure = new_figure(len(runs), 1, sum(_HEIGHTS))
    panels = figure.subplots(3, len(runs), squeeze=False, height_ratios=_HEIGHTS)
    for column, (method, tree) in zip(panels.T, runs.items(), strict=True):
        _whole(column[0], method, tree)
        for axes, frame in zip(column[1:], (0, -1), strict=True):
            _near(axes, method, tree, frame)
    legend_below(figure, [_key()])
    return figure


def _whole(axes: Any, method: Method, tree: xr.DataTree) -> None:
    for frame in (0, -1):
        _domains(axes, method, tree, frame, 0.15)
        _surfaces(axes, method, tree, frame, 0.7, "")
    axes.set_aspect("equal")
    axes.set_xlim(-0.4, 20.4)
    axes.set_ylim(-0.3, 5.0)
    dress(axes, "x [m]", "y [m]", str(method))  # times are in the titles below
    axes.grid(False)


def _near(axes: Any, method: Method, tree: xr.DataTree, frame: int) -> None:
    """Enlarge the place under the cylinder's centre, with the cells of the grid."""
    h = float(tree.attrs["cell_size"])
    centre = float(tree[f"particles/{BODY}"]["position"].isel(time=frame).sel(axis="x").mean())
    left, bottom = centre - 0.5 * _ZOOM[0], _TOP - 0.4 * _ZOOM[1]
    # Grid lines are at whole multiples of h from its lower corner, which the shipped scene has at -4 h
    for draw_line, first, size in ((axes.axvline, left, _ZOOM[0]), (axes.axhline, bottom, _ZOOM[1])):
        for position in h * np.arange(np.floor(first / h), np.ceil((first + size) / h) + 1):
            draw_line(position, **_CELLS)
    _domains(axes, method, tree, frame, 0.4)
    _surfaces(axes, method, tree, frame, 1.3, "o")
    axes.set_aspect("equal")
    axes.set_xlim(left, left + _ZOOM[0])
    axes.set_ylim(bottom, bottom + _ZOOM[1])
    motion = motion_of(tree)
    time, gap = motion.time[frame], float(motion.gap[frame])
    said = f"gap {gap:.2f} h" if gap > 0.0 else f"penetration {-gap:.3f} h"
    if gap > 0.05:
        arrow = {"arrowstyle": "<->", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (centre, _TOP), (centre, _TOP + gap * h), arrowprops=arrow)
    dress(axes, "x [m]", "y [m]", f"{time:.3f} s: {said}")
    axes.grid(False)


def _domains(axes: Any, method: Method, tree: xr.DataTree, frame: int, width: float) -> None:
    """Quadrilaterals of the material points; a quarter of the cylinder is dark, to show how it turned."""
    for body, group in tree["particles"].children.items():
        corners = group["corners"]
        colours: Any = _GREY[body]
        if body == BODY:
            start = group["position"].isel(time=0).values
            marked = (start > start.mean(axis=0)).all(axis=1)
            colours = [to_rgba(_COLOURS[method.contact], _SHADE if dark else 0.1) for dark in marked]
        quads = PolyCollection(
            list(corners.isel(time=frame).values), facecolors=colours, edgecolors="0.45", linewidths=width
        )
        axes.add_collection(quads)


def _surfaces(axes: Any, method: Method, tree: xr.DataTree, frame: int, width: float, marker: str) -> None:
    for body, group in tree["surface"].children.items():
        start = group["position"].isel(time=frame).values
        segments = np.stack([start, start[group["next"].values]], axis=1)
        colour = _COLOURS[method.contact] if body == BODY else "0.15"
        style = {"color": colour, "linewidth": width, "marker": marker, "markersize": 2.5}
        axes.plot(*segments.transpose(2, 1, 0), **style)


def _key() -> list[Any]:
    return [
        Patch(facecolor="0.93", edgecolor="0.45", linewidth=0.4, label="particles' domains"),
        Patch(facecolor="0.7", edgecolor="0.45", linewidth=0.4, label="a quarter, marked"),
        Line2D([], [], color="0.15", marker="o", markersize=2.5, linewidth=1.3, label="surface, nodes"),
        Line2D([], [], **_CELLS, label="cells of the grid"),
    ]
