"""CPU time of each method by stage of the step."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.plots.study_grid import label_of, order_of, problems_of, resolution_of, runs_of, with_methods
from mpmfw.plots.style import combinations, dress, head, journal_style, legend_below, new_panels
from mpmfw.state.fields import STEP_STAGES

#: Of the stages, and a grey for settling.
_COLOURS = ("#0072B2", "#56B4E9", "#009E73", "#D55E00", "#E69F00", "#CC79A7", "#6B6B6B")


@journal_style()
def cost_bars(dataset: xr.Dataset) -> Figure:
    """Draw CPU time per material point and step, stacked by stage."""
    rows = []
    for contact, shape, run in combinations(dataset):
        work = run["steps"] * run["material_points"]
        run = run.assign(stage_time=1e9 * run["cpu_stage"] / work.where(work > 0.0))
        rows.append({"contact": contact, "shape": shape, "dims": ["contact", "shape"], "run": run})
    return _bars({"": rows}, list(STEP_STAGES), "CPU time [ns per point and step]", dataset)


@journal_style()
def stages(dataset: xr.Dataset) -> Figure:
    """Draw CPU time of a study by stage, at the finest resolution that ran."""
    named = with_methods(dataset)
    resolution = resolution_of(named)
    bars = {}
    for title, problem in problems_of(named):
        rows = list(runs_of(_finest(problem, resolution)))
        finest = "" if resolution is None else label_of(resolution, rows[0][resolution])
        bars[", ".join(part for part in (title, finest) if part)] = rows
    return _bars(bars, [str(name) for name in named["stage"].values], "CPU time [s]")


def _bars(
    bars: dict[str, list[dict[str, Any]]], names: list[str], label: str, compared: xr.Dataset | None = None
) -> Figure:
    longest = max(len(rows) + len(_places(rows)[1]) for rows in bars.values())
    figure, panels = new_panels(len(bars), 16.0 + 4.2 * longest, sharex=True, sharey=True)
    if compared is not None:
        head(figure, compared)
    for axes, (title, rows) in zip(panels, bars.items(), strict=True):
        _draw_bars(axes, rows, names)
        dress(axes, label, "", title)
        axes.grid(False, axis="y")
    panels[0].invert_yaxis()  # shared: the first combination on top of every panel
    drawn = [row["run"]["stage_time"] for rows in bars.values() for row in rows]
    occurs = [any(float(times.sel(stage=name)) > 0.0 for times in drawn) for name in names]
    handles = list(itertools.compress(panels[0].get_legend_handles_labels()[0], occurs))
    half = (len(handles) + 1) // 2
    legend_below(figure, [handles[:half], handles[half:]])
    return figure


def _finest(problem: xr.Dataset, resolution: str | None) -> xr.Dataset:
    if resolution is None:
        return problem
    parts = [problem.sel({resolution: label}) for label in order_of(problem, resolution)[::-1]]
    return next((part for part in parts if np.isfinite(part["cpu_time"]).any()), parts[0]).expand_dims(
        resolution
    )


def _places(rows: list[dict[str, Any]]) -> tuple[list[float], dict[float, str]]:
    if not rows or not {"contact", "shape"} <= set(rows[0]["dims"]):
        return [float(k) for k in range(len(rows))], {}
    places: list[float] = []
    heads: dict[float, str] = {}
    for row in rows:
        if str(row["contact"]) not in heads.values():
            heads[float(len(places) + len(heads))] = str(row["contact"])
        places.append(float(len(places) + len(heads)))
    return places, heads


def _draw_bars(axes: Any, rows: list[dict[str, Any]], names: list[str]) -> None:
    places, heads = _places(rows)
    left = np.zeros(len(rows))
    for name, colour in zip(names, itertools.cycle(_COLOURS), strict=False):
        widths = np.array([float(np.nan_to_num(row["run"]["stage_time"].sel(stage=name))) for row in rows])
        axes.barh(places, widths, left=left, color=colour, label=name, height=0.72)
        left += widths
    dims = ("shape",) if heads else ("contact", "shape")
    labels = [", ".join(str(row[dim]) for dim in row["dims"] if dim in dims) for row in rows]
    axes.set_yticks(places, labels)
    axes.set_ylim(-0.8, max(places, default=0.0) + 0.8)
    for place, contact in heads.items():
        axes.text(0.01, place, contact, va="center", transform=axes.get_yaxis_transform())
    for k, row in enumerate(rows):
        status = str(row["run"]["status"].item()).partition(":")[0]
        if status != "ok":
            axes.text(left[k], places[k], f" {status}", va="center")
