"""The picture of a point: its domain on the grid, its nodes and their weights."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.plots.style import dress
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import OutsideGrid, Stencil
from mpmfw_testing.check import Picture
from mpmfw_testing.shape.placement import Placement
from mpmfw_testing.shape.sums import entries_of

#: Area of a node's disc for the weight 1 [points²].
FULL = 420.0
_POSITIVE, _NEGATIVE, _DOMAIN = "#0072B2", "#D55E00", "#009E73"


def picture_of(placement: Placement, point: int) -> Picture:
    """Picture of one material point; in 3D seen along z, weights summed over what lies behind each other."""
    grid = placement.grid
    centre = (placement.particles.position[point] - grid.lower) / grid.cell_size
    outline = _outline(placement, point)
    nodes, weights = _seen(placement, point)
    window = _window(placement, point)

    def draw(axes: Any) -> None:
        seen = np.concatenate([nodes if len(nodes) else window, outline, centre[None, :2]])
        seen = seen[np.isfinite(seen).all(axis=1)]
        if len(seen):
            _frame(axes, seen.min(axis=0), seen.max(axis=0))
        if placement.dim == 3:
            axes.set_ylabel("y [cells], seen along z")
        key = axes.fill(*outline.T, facecolor=_DOMAIN, alpha=0.3, edgecolor=_DOMAIN, label="domain")
        key += axes.plot(*centre[:2], "+", color="black", markersize=7, linestyle="", label="point")
        for colour, sign, name in ((_POSITIVE, 1.0, "weight > 0"), (_NEGATIVE, -1.0, "weight < 0")):
            own = sign * weights > 0.0
            if own.any():
                size = FULL * np.minimum(np.abs(weights[own]), 1.0)
                axes.scatter(*nodes[own].T, s=size, color=colour, alpha=0.7, linewidth=0)
                key += axes.plot([], [], "o", color=colour, markersize=5, linestyle="", label=name)
        for node, weight in zip(nodes, weights, strict=True):
            if weight != 0.0:
                axes.annotate(f"{weight:.3g}", node, xytext=(3, 3), textcoords="offset points")
        if _crosses(window, axes.get_xlim(), axes.get_ylim()):
            key += axes.plot(*window.T, linestyle="--", linewidth=0.9, color="0.35", label="window")
        # below the axes' own label, since the figure's foot belongs to the numbers of the case
        axes.legend(
            handles=key,
            loc="upper center",
            bbox_to_anchor=(0.5, -0.2),
            ncols=5,
            columnspacing=0.9,
            handletextpad=0.3,
            handlelength=1.4,
        )

    return draw


def _outline(placement: Placement, point: int) -> FloatArray:
    """Corners of the domain, (4, 2) [cells]; in 3D of its projection along z, which is the face's."""
    edges = placement.half_edges(point)[:2, :2] / placement.grid.cell_size
    centre = (placement.particles.position[point] - placement.grid.lower)[:2] / placement.grid.cell_size
    signs = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    corners: FloatArray = centre + signs @ edges.T
    return corners


def _seen(placement: Placement, point: int) -> tuple[FloatArray, FloatArray]:
    """Nodes (k, 2) [cells] and their weights (k,), equal nodes added; none if the table cannot be filled."""
    grid = placement.grid
    try:
        table: Stencil = placement.fill()
    except OutsideGrid:
        return np.zeros((0, 2)), np.zeros(0)
    own = entries_of(table, point)
    inside = (table.nodes[own] >= 0) & (table.nodes[own] < len(grid.position))
    nodes = (grid.position[table.nodes[own][inside]] - grid.lower)[:, :2] / grid.cell_size
    places, which = np.unique(np.rint(nodes), axis=0, return_inverse=True)
    weights = np.zeros(len(places))
    np.add.at(weights, which.ravel(), table.weight[own][inside])
    return places, weights


def _crosses(window: FloatArray, x: tuple[float, float], y: tuple[float, float]) -> bool:
    """Whether a side of the window lies within the frame."""
    low, high = window.min(axis=0), window.max(axis=0)
    return bool(low[0] >= x[0] or low[1] >= y[0] or high[0] <= x[1] or high[1] <= y[1])


def _window(placement: Placement, point: int) -> FloatArray:
    """Closed outline of the first to the last nodes of the point's window, (5, 2) [cells]."""
    field = int(np.searchsorted(placement.particles.first, point, side="right")) - 1
    low = placement.grid.window_lower[field, :2]
    high = low + placement.grid.window_shape[field, :2] - 1
    return np.array([low, (high[0], low[1]), high, (low[0], high[1]), low], dtype=float)


def _frame(axes: Any, low: FloatArray, high: FloatArray) -> None:
    """Grid lines a cell round what is seen, and the labels."""
    low, high = np.floor(low - 0.5), np.ceil(high + 0.5)
    dress(axes, "x [cells from the grid's first node]", "y [cells]")
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    if (high - low).max() <= 40:
        axes.set_xticks(np.arange(low[0], high[0] + 1))
        axes.set_yticks(np.arange(low[1], high[1] + 1))
    axes.set_aspect("equal")
