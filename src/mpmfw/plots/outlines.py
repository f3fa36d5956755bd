"""Outlines of the bodies at the start and at the end ([H17] figure 2)."""

from __future__ import annotations

import itertools

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.plots import style
from mpmfw.plots.scene import moving_bodies
from mpmfw.results.stored_scene import own_attributes, scene_of_results

_DASHED = (0, (3, 3))


@style.journal_style()
def positions(dataset: xr.Dataset) -> Figure:
    """Draw first outlines (dashed) and last ones, one panel for each method, all at one scale.

    Raise ValueError without an outline.
    """
    runs = [one for one in style.combinations(dataset) if np.isfinite(one[2]["outline"].values).any()]
    if not runs:
        raise ValueError("no run of the comparison stored an outline")
    points = np.concatenate([run["outline"].values.reshape(-1, 2) for _, _, run in runs])
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    scene = scene_of_results(own_attributes(style.at_last(dataset)))
    if scene is not None:  # rigid bodies may leave the grid
        low, high = np.maximum(low, scene.grid.lower), np.minimum(high, scene.grid.upper)
    margin = 0.04 * (high - low).max()
    low, high = low - margin, high + margin
    height = min(22.0 * style.PANEL * float(np.divide(*(high - low)[::-1])), 110.0) + 17.0
    figure, panels = style.new_panels(len(runs), height)
    figure.set_layout_engine("compressed")
    style.head(figure, dataset)
    moving, turn = moving_bodies(dataset), itertools.cycle(style.CYCLE)
    names = [str(name) for name in dataset["body"].values]
    colours = {name: next(turn) if name in moving else "0.45" for name in names}
    scale, unit = style.length_scale(float((high - low).max()))
    for axes, (contact, name, run) in zip(panels, runs, strict=True):
        for frame, dashes in (("last", "-"), ("first", _DASHED)):
            lines = run["outline"].sel(frame=frame).values
            for body, line in zip(run["outlined_body"].values, lines, strict=True):
                axes.plot(*(scale * line).T, color=colours[str(body)], linestyle=dashes, linewidth=0.9)
        axes.set_aspect("equal")
        axes.set_xlim(scale * low[0], scale * high[0])
        axes.set_ylim(scale * low[1], scale * high[1])
        end = float(run["outline_time"].sel(frame="last"))
        time, of_time = style.time_scale(end)
        last = f"{time * end:.4g} {of_time}"
        style.dress(axes, f"x [{unit}]", f"y [{unit}]", f"{contact}, {name}, {last}")
        axes.grid(False)
    key = [style.entry(name, color=colour, linewidth=2.0) for name, colour in colours.items()]
    style.legend_below(figure, [[*key, style.entry("start", color="0.3", linestyle=_DASHED)]])
    return figure
