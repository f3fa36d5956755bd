"""Outlines of the bodies at the start and at the end ([H17] figure 2)."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.plots.scene import moving_bodies
from mpmfw.plots.style import (
    PANEL,
    at_last,
    combinations,
    drawn_reference,
    dress,
    entry,
    head,
    journal_style,
    legend_below,
    length_scale,
    new_figure,
    time_scale,
)
from mpmfw.results.analysis import GAP_ROUND_OFF
from mpmfw.results.references import RollingReference, cell_size, own_attributes, scene_of_results

#: Bodies by colour, in the scene's order; those that stand still are grey.
_BODIES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_DASHED = (0, (3, 3))


def _outlined(dataset: xr.Dataset) -> list[tuple[str, str, xr.Dataset]]:
    """Return contact, shape and data of the runs with outlines."""
    return [one for one in combinations(dataset) if np.isfinite(one[2]["outline"].values).any()]


def only_shape(dataset: xr.Dataset) -> str | None:
    """Return the shape whose runs alone are drawn of a rolling body; None if all shapes are drawn."""
    return _outlined(dataset)[-1][1] if isinstance(drawn_reference(dataset), RollingReference) else None


@journal_style()
def positions(dataset: xr.Dataset, shape: str | None = None) -> Figure:
    """First outlines (dashed) and last ones, one panel for each method, all at one scale.

    Below a rolling cylinder a part is enlarged. Raise ValueError without an outline.
    """
    runs = _outlined(dataset)
    if not runs:
        raise ValueError("no run of the comparison stored an outline")
    closer = isinstance(drawn_reference(dataset), RollingReference)
    if shape is not None or closer:
        chosen = shape or only_shape(dataset)
        runs = [one for one in runs if one[1] == chosen]
        if not runs:
            raise ValueError(f"no run with shape '{chosen}' stored an outline")
    points = np.concatenate([run["outline"].values.reshape(-1, 2) for _, _, run in runs])
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    scene = scene_of_results(own_attributes(at_last(dataset)))
    if scene is not None:  # rigid bodies may leave the grid
        low, high = np.maximum(low, scene.grid.lower), np.minimum(high, scene.grid.upper)
    margin = 0.04 * (high - low).max()
    low, high = low - margin, high + margin
    columns = 2 if closer or len(runs) > 1 else 1
    rows = len(runs) if closer else -(-len(runs) // columns)
    height = 40.0 if closer else min(22.0 * PANEL * float(np.divide(*(high - low)[::-1])), 110.0) + 17.0
    figure = new_figure(columns, rows, height)
    if not closer:
        figure.set_layout_engine("compressed")
    head(figure, dataset)
    grid = figure.subplots(rows, columns, squeeze=False, width_ratios=(6, 1) if closer else None)
    panels = grid[:, 0] if closer else grid.ravel()
    colours = _body_colours(dataset)
    scale, unit = length_scale(float((high - low).max()))
    for k, (axes, (contact, name, run)) in enumerate(zip(panels, runs, strict=False)):
        _draw_outlines(axes, run, colours, scale)
        axes.set_aspect("equal")
        axes.set_xlim(scale * low[0], scale * high[0])
        axes.set_ylim(scale * low[1], scale * high[1])
        time, of_time = time_scale(float(run["outline_time"].sel(frame="last")))
        last = f"{time * float(run['outline_time'].sel(frame='last')):.4g} {of_time}"
        title = f"{contact}, {name}, {last}{_gap_text(run) if closer else ''}"
        dress(axes, f"x [{unit}]", f"y [{unit}]", f"({chr(ord('a') + k)}) {title}" if rows > 1 else title)
        axes.grid(False)
        if closer:
            _draw_closer(axes, grid[k, 1], run, colours, scale)
    for axes in panels[len(runs) :]:
        axes.remove()
    key = [entry(name, color=colour, linewidth=2.0) for name, colour in colours.items()]
    legend_below(figure, [[*key, entry("start", color="0.3", linestyle=_DASHED)]])
    return figure


def _draw_outlines(axes: Any, run: xr.Dataset, colours: dict[str, str], scale: float) -> None:
    for frame, style in (("last", "-"), ("first", _DASHED)):
        lines = run["outline"].sel(frame=frame).values
        for name, line in zip(run["outlined_body"].values, lines, strict=True):
            axes.plot(*(scale * line).T, color=colours[str(name)], linestyle=style, linewidth=0.9)


def _body_colours(dataset: xr.Dataset) -> dict[str, str]:
    moving = set(moving_bodies(dataset))
    names = [str(name) for name in dataset["body"].values]
    turn = iter(_BODIES * (1 + len(names) // len(_BODIES)))
    return {name: next(turn) if name in moving else "0.45" for name in names}


def _gap_text(run: xr.Dataset) -> str:
    known = run["min_gap"].isel(pair=0).dropna("time").values if "min_gap" in run else np.empty(0)
    if len(known) == 0:
        return ""
    h = cell_size(run)
    if abs(float(known[-1])) < GAP_ROUND_OFF * h:
        return ", gap 0"
    size, what = abs(float(known[-1])), "gap" if known[-1] > 0.0 else "penetration"
    cells = f" = {size / h:.2g} cells" if h > 0.0 else ""
    return f", {what} {1e3 * size:.3g} mm{cells}"


def _draw_closer(axes: Any, near: Any, run: xr.Dataset, colours: dict[str, str], scale: float) -> None:
    """Draw the place under the body that moved most, enlarged."""
    first, last = (scale * run["outline"].sel(frame=frame).values for frame in ("first", "last"))
    near.set_xticks([])
    near.set_yticks([])
    there = np.asarray(np.isfinite(last).any(axis=(1, 2)))
    if not there.any():
        near.set_axis_off()
        return
    far = [
        np.nanmax(np.abs(line - start)) if known else 0.0
        for line, start, known in zip(last, first, there, strict=True)
    ]
    mover = last[int(np.argmax(far))]
    x, y = mover[np.nanargmin(mover[:, 1])]
    span = 0.22 * float(np.nanmax(mover[:, 0]) - np.nanmin(mover[:, 0]))
    scene = scene_of_results(own_attributes(run))
    if scene is not None and scene.dim == 2:
        h = scale * float(scene.grid.cell_size)
        for middle, start, draw in zip((x, y), scene.grid.lower, (near.axvline, near.axhline), strict=True):
            begin = scale * start
            for k in range(int(np.ceil((middle - span - begin) / h)), int((middle + span - begin) / h) + 1):
                draw(begin + k * h, color="0.8", linewidth=0.5, zorder=0)
    for name, line in zip(run["outlined_body"].values, last, strict=True):
        near.plot(*line.T, color=colours[str(name)], linewidth=0.9, marker=".", markersize=2)
    near.set_aspect("equal")
    near.set_xlim(x - span, x + span)
    near.set_ylim(y - span, y + span)
    axes.indicate_inset_zoom(near, edgecolor="0.4", linewidth=0.6)
