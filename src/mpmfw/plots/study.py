"""Figures of a study: error over CPU time with the Pareto front, and CPU time by stage of the step."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from mpmfw.plots import style
from mpmfw.results.selection import points_of
from mpmfw.state.fields import STEP_STAGES, FloatArray

#: Dimensions that are lengths [m].
_LENGTHS = ("cell_size", "particle_size", "segment")
#: Dimensions that are a resolution, the more usual first.
_RESOLUTIONS = ("cell_size", "particle_size", "particles_per_cell", "size", "segment", "cfl", "safety")


def with_methods(dataset: xr.Dataset) -> xr.Dataset:
    """Return the study with dimensions of contact and shape."""
    for name in ("contact", "shape"):
        if name not in dataset.dims:
            label = dataset[name].item() if name in dataset.coords else "the scene's"
            dataset = dataset.drop_vars(name, errors="ignore").expand_dims({name: [label]})
    return dataset


def problems_of(dataset: xr.Dataset) -> Iterator[tuple[str, xr.Dataset]]:
    """Yield the parts of a study that can be compared, by title."""
    for labels, problem in points_of(dataset, json.loads(dataset.attrs["problem_dims"])):
        yield ", ".join(str(v) if dim == "scene" else f"{dim} {v}" for dim, v in labels.items()), problem


def runs_of(dataset: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield every run with its labels."""
    for labels, run in points_of(dataset, dataset["error"].dims):
        yield {**labels, "dims": list(labels), "run": run}


def resolution_of(dataset: xr.Dataset) -> str | None:
    """Return the dimension that the size of markers stands for, if any."""
    problem_dims = json.loads(dataset.attrs["problem_dims"])
    dims = [
        str(dim)
        for dim in dataset["error"].dims
        if dim not in ("contact", "shape", *problem_dims) and dataset.sizes[dim] > 1
    ]
    usual = [dim for dim in _RESOLUTIONS if dim in dims]
    return next(iter(usual + dims), None)


def order_of(dataset: xr.Dataset, resolution: str) -> list[Any]:
    """Return the labels of the resolution, the coarsest first."""
    labels = dataset[resolution].values.tolist()
    if all(isinstance(label, int | float) for label in labels):
        return sorted(labels, reverse=resolution != "particles_per_cell")
    return list(labels)


def label_of(resolution: str, label: Any) -> str:
    """Return a label such as ``cell size 0.2 m``."""
    unit = " m" if resolution in _LENGTHS and not isinstance(label, str) else ""
    return f"{resolution.replace('_', ' ')} {label}{unit}"


#: Marker sizes [pt] of the coarsest and the finest resolution.
_SIZES = (5.5, 3.5)
#: Line at the target error of a study.
_LIMIT: dict[str, Any] = {"color": "0.55", "linewidth": 0.6, "linestyle": (0, (4, 3))}


def study_figures(dataset: xr.Dataset) -> dict[str, tuple[Figure, str]]:
    """Return the figures of a study, ``{name: (figure, caption)}``."""
    figures: dict[str, tuple[Figure, str]] = {}
    timing, without = dataset.attrs.get("timing", ""), "; ".join(_without_result(with_methods(dataset)))
    if (np.isfinite(dataset["error"]) & (dataset["error"] > 0) & np.isfinite(dataset["cpu_time"])).any():
        figures["front"] = (
            front(dataset),
            "Error over CPU time with the range of the repeats. The line joins filled runs, which no other "
            f"one beats in both. Timing: {timing}." + (f" Without a result: {without}." if without else ""),
        )
    if np.isfinite(dataset["stage_time"]).any():
        figures["stages"] = (stages(dataset), f"CPU time by stage of the step. Timing: {timing}.")
    return figures


@style.journal_style()
def front(dataset: xr.Dataset) -> Figure:
    """Draw error over CPU time of a study, a panel a problem, with the Pareto front; size is resolution."""
    named = with_methods(dataset)
    problems = list(problems_of(named))
    look, resolution = style.Look(named), resolution_of(named)
    figure, panels = style.new_panels(len(problems), 54.0, 1 if len(problems) <= 2 else 2, sharey=True)
    for axes, (title, problem) in zip(panels, problems, strict=True):
        _draw_front(axes, problem)
        for row in runs_of(problem):
            _draw_run(axes, row, look, _size(named, resolution, row))
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.margins(y=0.12)
        axes.axhline(100.0 * float(dataset.attrs["under"]), zorder=0, **_LIMIT)
        quantity = str(dataset.attrs["quantity"]).replace("-", " ")
        ylabel = f"error of {quantity} [%]" if axes.get_subplotspec().is_first_col() else ""
        if without := len(_without_result(problem)):
            title = f"{title} ({without} without a result)".strip()
        style.dress(axes, "CPU time [s]", ylabel, title)
        _plain_ticks(axes)
    key = _key(named, look, resolution)
    most = max(map(len, key))
    style.legend_below(figure, key, most=most, columnspacing=0.8, handlelength=1.3, handletextpad=0.5)
    return figure


def _size(dataset: xr.Dataset, resolution: str | None, row: dict[str, Any]) -> float:
    if resolution is None:
        return 5.0
    order = order_of(dataset, resolution)
    return float(np.interp(order.index(row[resolution]), (0, max(1, len(order) - 1)), _SIZES))


def _without_result(dataset: xr.Dataset) -> list[str]:
    """Return the labels of runs that failed, were refused or did not run."""
    return [
        ", ".join(str(row[dim]) for dim in row["dims"])
        for row in runs_of(dataset)
        if str(row["run"]["status"].item()) != "ok" and not np.isfinite(row["run"]["error"])
    ]


def _draw_run(axes: Any, row: dict[str, Any], look: style.Look, size: float) -> None:
    """Draw a run with the range of its repeats: filled and with a dark edge on the front, open else."""
    run, colour = row["run"], look.colours[row["contact"]]
    if not (np.isfinite(run["error"]) and run["error"] > 0.0 and np.isfinite(run["cpu_time"])):
        return  # a logarithmic axis cannot show it
    cost, spread = float(run["cpu_time"]), float(np.nan_to_num(run["cpu_time_spread"]))
    on = bool(run["pareto"])
    axes.errorbar(
        cost,
        100.0 * float(run["error"]),
        xerr=[[0.0], [2.0 * spread]],  # the cost is the least of the repeats, the spread half their range
        color=colour,
        elinewidth=0.6,
        linestyle="",
        marker=look.styles[row["shape"]][1],
        markersize=size,
        markeredgecolor="black" if on else colour,
        markerfacecolor=colour if on else "white",
        markeredgewidth=0.7,
        zorder=6 if on else 5,
    )


def _draw_front(axes: Any, problem: xr.Dataset) -> None:
    on = problem["pareto"].values
    cost, error = problem["cpu_time"].values[on], 100.0 * problem["error"].values[on]
    order = np.argsort(cost)
    axes.plot(cost[order], error[order], drawstyle="steps-post", color="0.25", linewidth=0.9, zorder=2)


def _plain_ticks(axes: Any) -> None:
    for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        decades = np.log10(limits[1] / limits[0])
        axis.set_major_locator(LogLocator(subs=(1.0,) if decades > 2.5 else (1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def _key(dataset: xr.Dataset, look: style.Look, resolution: str | None) -> list[list[Artist]]:
    colours, _ = look.key()
    grey: dict[str, Any] = {"color": "0.3", "linestyle": "", "markersize": 5}
    markers = [style.entry(name, marker=marker, **grey) for name, (_, marker) in look.styles.items()]
    filled: dict[str, Any] = {"markerfacecolor": "0.6", "markeredgecolor": "black", "markersize": 4}
    lines = [
        style.entry("front", color="0.25", linewidth=0.9, marker="o", **filled),
        style.entry(f"{100.0 * float(dataset.attrs['under']):g} %", **_LIMIT),
    ]
    sizes = []
    if resolution is not None:
        for label in order_of(dataset, resolution):
            size = _size(dataset, resolution, {resolution: label})
            sizes.append(style.entry(label_of(resolution, label), marker="o", **grey | {"markersize": size}))
    return [colours, markers, [*sizes, *lines]] if len(sizes) <= 2 else [colours, markers, sizes, lines]


#: Of the stages, and a grey for settling.
_COLOURS = ("#0072B2", "#56B4E9", "#009E73", "#D55E00", "#E69F00", "#CC79A7", "#6B6B6B")


@style.journal_style()
def cost_bars(dataset: xr.Dataset) -> Figure:
    """Draw CPU time per material point and step, stacked by stage."""
    rows = []
    for contact, shape, run in style.combinations(dataset):
        if "code" in run and str(run["code"].item()):
            continue  # another code does not say what its stages take
        work = run["steps"] * run["material_points"]
        run = run.assign(stage_time=1e9 * run["cpu_stage"] / work.where(work > 0.0))
        rows.append({"contact": contact, "shape": shape, "dims": ["contact", "shape"], "run": run})
    return _bars({"": rows}, list(STEP_STAGES), "CPU time [ns per point and step]", dataset)


@style.journal_style()
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
    longest = max(float(_places(rows)[1].sum()) for rows in bars.values())
    figure, panels = style.new_panels(len(bars), 16.0 + 4.2 * longest, sharex=True, sharey=True)
    if compared is not None:
        style.head(figure, compared)
    for axes, (title, rows) in zip(panels, bars.items(), strict=True):
        _draw_bars(axes, rows, names)
        style.dress(axes, label, "", title)
        axes.grid(False, axis="y")
    panels[0].invert_yaxis()  # shared: the first combination on top of every panel
    drawn = [row["run"]["stage_time"] for rows in bars.values() for row in rows]
    occurs = [any(float(times.sel(stage=name)) > 0.0 for times in drawn) for name in names]
    handles = list(itertools.compress(panels[0].get_legend_handles_labels()[0], occurs))
    half = (len(handles) + 1) // 2
    style.legend_below(figure, [handles[:half], handles[half:]])
    return figure


def _finest(problem: xr.Dataset, resolution: str | None) -> xr.Dataset:
    if resolution is None:
        return problem
    parts = [problem.sel({resolution: label}) for label in order_of(problem, resolution)[::-1]]
    found = next((part for part in parts if np.isfinite(part["cpu_time"]).any()), parts[0])
    return found.expand_dims(resolution)


def _places(rows: list[dict[str, Any]]) -> tuple[list[str], FloatArray]:
    """Return labels of the bars, some of several lines, and the room for each, 1 for a line."""
    plain = (", ".join(str(row[dim]) for dim in row["dims"] if dim in ("contact", "shape")) for row in rows)
    labels = list(map(style.on_lines, plain))
    return labels, np.array([max(1.0, 0.75 * (1 + label.count("\n"))) for label in labels])


def _draw_bars(axes: Any, rows: list[dict[str, Any]], names: list[str]) -> None:
    labels, room = _places(rows)
    places, left = np.cumsum(room) - 0.5 * (room + 1.0), np.zeros(len(rows))
    for name, colour in zip(names, itertools.cycle(_COLOURS), strict=False):
        widths = np.array([float(np.nan_to_num(row["run"]["stage_time"].sel(stage=name))) for row in rows])
        axes.barh(places, widths, left=left, color=colour, label=name, height=0.72)
        left += widths
    axes.set_yticks(places, labels)
    axes.set_ylim(-0.8, room.sum() - 0.2)
    for k, row in enumerate(rows):
        status = str(row["run"]["status"].item()).partition(":")[0]
        if status != "ok":
            axes.text(left[k], places[k], f" {status}", va="center")
