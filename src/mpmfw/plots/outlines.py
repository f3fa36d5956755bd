"""Outlines of the bodies at the start and at the end ([H17] figure 2)."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.plots.scene import moving_bodies
from mpmfw.plots.style import (
    PANEL,
    at_last,
    combinations,
    dress,
    entry,
    head,
    journal_style,
    legend_below,
    length_scale,
    new_panels,
    time_scale,
)
from mpmfw.results.stored_scene import own_attributes, scene_of_results

#: Bodies by colour, in the scene's order; those that stand still are grey.
_BODIES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_DASHED = (0, (3, 3))


@journal_style()
def positions(dataset: xr.Dataset) -> Figure:
    """Draw first outlines (dashed) and last ones, one panel for each method, all at one scale.

    Raise ValueError without an outline.
    """
    runs = [one for one in combinations(dataset) if np.isfinite(one[2]["outline"].values).any()]
    if not runs:
        raise ValueError("no run of the comparison stored an outline")
    points = np.concatenate([run["outline"].values.reshape(-1, 2) for _, _, run in runs])
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    scene = scene_of_results(own_attributes(at_last(dataset)))
    if scene is not None:  # rigid bodies may leave the grid
        low, high = np.maximum(low, scene.grid.lower), np.minimum(high, scene.grid.upper)
    margin = 0.04 * (high - low).max()
    low, high = low - margin, high + margin
    height = min(22.0 * PANEL * float(np.divide(*(high - low)[::-1])), 110.0) + 17.0
    figure, panels = new_panels(len(runs), height)
    figure.set_layout_engine("compressed")
    head(figure, dataset)
    colours = _body_colours(dataset)
    scale, unit = length_scale(float((high - low).max()))
    for axes, (contact, name, run) in zip(panels, runs, strict=True):
        _draw_outlines(axes, run, colours, scale)
        axes.set_aspect("equal")
        axes.set_xlim(scale * low[0], scale * high[0])
        axes.set_ylim(scale * low[1], scale * high[1])
        time, of_time = time_scale(float(run["outline_time"].sel(frame="last")))
        last = f"{time * float(run['outline_time'].sel(frame='last')):.4g} {of_time}"
        dress(axes, f"x [{unit}]", f"y [{unit}]", f"{contact}, {name}, {last}")
        axes.grid(False)
    key = [entry(name, color=colour, linewidth=2.0) for name, colour in colours.items()]
    legend_below(figure, [[*key, entry("start", color="0.3", linestyle=_DASHED)]])
    return figure


def _draw_outlines(axes: Any, run: xr.Dataset, colours: dict[str, str], scale: float) -> None:
    for frame, style in (("last", "-"), ("first", _DASHED)):
        lines = run["outline"].sel(frame=frame).values
        for name, line in zip(run["outlined_body"].values, lines, strict=True):
            axes.plot(*(scale * line).T, color=colours[str(name)], linestyle=style, linewidth=0.9)


def _body_colours(dataset: xr.Dataset) -> dict[str, str]:
    moving, turn = moving_bodies(dataset), itertools.cycle(_BODIES)
    names = [str(name) for name in dataset["body"].values]
    return {name: next(turn) if name in moving else "0.45" for name in names}
