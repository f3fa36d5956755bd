"""What accuracy costs: error over CPU time with the Pareto front, and where the time goes."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from mpmfw.plots.costs import _STAGE_COLOURS
from mpmfw.plots.style import FONT, Look, dress, legend_below, new_figure

#: Marker sizes [pt] of the coarsest and the finest resolution.
_SIZES = (6.5, 3.8)
#: As in the figure of a comparison's costs, and a grey for settling.
_COLOURS = (*_STAGE_COLOURS, "#6B6B6B")
#: Dimensions that are lengths [m].
_LENGTHS = ("cell_size", "particle_size", "segment")
#: Dimensions that are a resolution, the more usual first.
_RESOLUTIONS = ("cell_size", "particle_size", "particles_per_cell", "size", "segment", "cfl", "safety")


def study_figures(dataset: xr.Dataset) -> dict[str, tuple[Figure, str]]:
    """Figures of a study: ``{name: (figure, caption)}``; none where no error or no cost is known."""
    figures: dict[str, tuple[Figure, str]] = {}
    timing = dataset.attrs.get("timing", "")
    if (np.isfinite(dataset["error"]) & (dataset["error"] > 0) & np.isfinite(dataset["cpu_time"])).any():
        figures["front"] = (
            front(dataset),
            "Error over CPU time; bars are the range of the repeats. The line joins the runs that no other one beats "
            f"in both. Timing: {timing}.",
        )
    if np.isfinite(dataset["stage_time"]).any():
        figures["stages"] = (stages(dataset), f"CPU time by stage of the step. Timing: {timing}.")
    return figures


def front(dataset: xr.Dataset) -> Figure:
    """Error over CPU time on logarithmic axes, one panel a problem, the Pareto front drawn.

    Parameters
    ----------
    dataset
        Of ``mpmfw.study``. Colour says the contact, marker the shape function, size the resolution.
    """
    named = _with_methods(dataset)
    problems = list(_problems(named))
    look, resolution = Look(named), _resolution(named)
    columns = min(2, len(problems))
    rows = -(-len(problems) // columns)
    figure = new_figure(columns, rows, 66.0)
    panels = figure.subplots(rows, columns, squeeze=False, sharey=True).ravel()
    for axes, (title, problem) in zip(panels, problems, strict=False):
        _draw_front(axes, problem)
        for row in _rows(problem):
            _draw_run(axes, row, look, _size(named, resolution, row))
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.margins(y=0.08)
        axes.axhline(
            100.0 * float(dataset.attrs["under"]),
            color="0.55",
            linewidth=0.6,
            linestyle=(0, (4, 3)),
            zorder=0,
        )
        dress(axes, "CPU time [s]", f"error of {_quantity(dataset)} [%]" if axes is panels[0] else "", title)
        _plain_ticks(axes)
    for axes in panels[len(problems) :]:
        axes.remove()
    _legend(figure, _key(named, look, resolution))
    return figure


def stages(dataset: xr.Dataset) -> Figure:
    """CPU time by stage as stacked bars, one for each combination at the finest resolution that ran."""
    named = _with_methods(dataset)
    resolution = _resolution(named)
    problems = list(_problems(named))
    bars = {title: list(_rows(_finest(problem, resolution))) for title, problem in problems}
    longest = max(map(len, bars.values()))
    columns = min(2, len(problems))
    lines = -(-len(problems) // columns)
    figure = new_figure(columns, lines, 16.0 + 4.2 * longest)
    panels = figure.subplots(lines, columns, squeeze=False, sharex=True, sharey=True).ravel()
    names = [str(name) for name in named["stage"].values]
    for axes, (title, rows) in zip(panels, bars.items(), strict=False):
        _draw_bars(axes, rows, names)
        finest = "" if resolution is None else _said(resolution, rows[0][resolution])
        dress(axes, "CPU time [s]", "", ", ".join(part for part in (title, finest) if part))
        axes.grid(False, axis="y")
    panels[0].invert_yaxis()  # shared: the first combination on top of every panel
    for axes in panels[len(problems) :]:
        axes.remove()
    handles = panels[0].get_legend_handles_labels()[0]
    legend_below(figure, [handles[:4], handles[4:]])
    return figure


def _with_methods(dataset: xr.Dataset) -> xr.Dataset:
    """The study with contact and shape as dimensions, even where there is one of each or none is known."""
    for name in ("contact", "shape"):
        if name not in dataset.dims:
            label = dataset[name].item() if name in dataset.coords else "the scene's"
            dataset = dataset.drop_vars(name, errors="ignore").expand_dims({name: [label]})
    return dataset


def _problems(dataset: xr.Dataset) -> Iterator[tuple[str, xr.Dataset]]:
    """The parts of a study whose errors and costs may be compared, by their title."""
    dims = json.loads(dataset.attrs["problem_dims"])
    for labels in itertools.product(*(dataset[dim].values.tolist() for dim in dims)):
        title = ", ".join(
            str(v) if dim == "scene" else f"{dim} {v}" for dim, v in zip(dims, labels, strict=True)
        )
        yield title, dataset.sel(dict(zip(dims, labels, strict=True)))


def _rows(dataset: xr.Dataset) -> Iterator[dict[str, Any]]:
    dims = [str(dim) for dim in dataset["error"].dims]
    for labels in itertools.product(*(dataset[dim].values.tolist() for dim in dims)):
        choice = dict(zip(dims, labels, strict=True))
        yield {**choice, "dims": dims, "run": dataset.sel(choice)}


def _resolution(dataset: xr.Dataset) -> str | None:
    """The dimension that the size of the markers says; None where there is none of several values."""
    problem_dims = json.loads(dataset.attrs["problem_dims"])
    dims = [
        str(dim)
        for dim in dataset["error"].dims
        if dim not in ("contact", "shape", *problem_dims) and dataset.sizes[dim] > 1
    ]
    usual = [dim for dim in _RESOLUTIONS if dim in dims]
    return next(iter(usual + dims), None)


def _order(dataset: xr.Dataset, resolution: str) -> list[Any]:
    """Labels of the resolution, the coarsest first where they are numbers."""
    labels = dataset[resolution].values.tolist()
    if all(isinstance(label, int | float) for label in labels):
        return sorted(labels, reverse=resolution != "particles_per_cell")
    return list(labels)


def _size(dataset: xr.Dataset, resolution: str | None, row: dict[str, Any]) -> float:
    if resolution is None:
        return 5.0
    order = _order(dataset, resolution)
    return float(np.interp(order.index(row[resolution]), (0, max(1, len(order) - 1)), _SIZES))


def _draw_run(axes: Any, row: dict[str, Any], look: Look, size: float) -> None:
    run = row["run"]
    error, cost = 100.0 * float(run["error"]), float(run["cpu_time"])
    if not (np.isfinite(error) and error > 0.0 and np.isfinite(cost)):
        return
    spread = float(np.nan_to_num(run["cpu_time_spread"]))
    on = bool(run["pareto"])
    axes.errorbar(
        cost,
        error,
        xerr=[[min(spread, 0.9 * cost)], [spread]],
        color=look.colours[row["contact"]],
        marker=look.styles[row["shape"]][1],
        markersize=size,
        markeredgecolor="black" if on else "white",
        markeredgewidth=0.9 if on else 0.3,
        elinewidth=0.6,
        linestyle="",
        alpha=1.0 if on else 0.75,
        zorder=5 if on else 3,
    )


def _draw_front(axes: Any, problem: xr.Dataset) -> None:
    """The front as stairs: at a cost, the least error that it buys."""
    on = problem["pareto"].values
    cost, error = problem["cpu_time"].values[on], 100.0 * problem["error"].values[on]
    order = np.argsort(cost)
    axes.plot(cost[order], error[order], drawstyle="steps-post", color="0.25", linewidth=0.9, zorder=2)


def _plain_ticks(axes: Any) -> None:
    """Numbers as they are written in words where the axis spans a few decades."""
    for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        decades = np.log10(limits[1] / limits[0])
        axis.set_major_locator(LogLocator(subs=(1.0,) if decades > 2.5 else (1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def _quantity(dataset: xr.Dataset) -> str:
    return str(dataset.attrs["quantity"]).replace("-", " ")


def _key(dataset: xr.Dataset, look: Look, resolution: str | None) -> list[list[Artist]]:
    """Rows of the legend: colours, markers, sizes, and the front."""
    colours: list[Artist] = [
        Line2D([], [], color=colour, linewidth=2.5, label=name) for name, colour in look.colours.items()
    ]
    markers: list[Artist] = [
        Line2D([], [], color="0.3", linestyle="", marker=marker, markersize=5, label=name)
        for name, (_, marker) in look.styles.items()
    ]
    limit = 100.0 * float(dataset.attrs["under"])
    lines: list[Artist] = [
        Line2D(
            [],
            [],
            color="0.25",
            linewidth=0.9,
            marker="o",
            markerfacecolor="white",
            markersize=4,
            label="front",
        ),
        Line2D([], [], color="0.55", linewidth=0.6, linestyle=(0, (4, 3)), label=f"{limit:g} %"),
    ]
    if resolution is None:
        return [colours, markers, lines]
    sizes: list[Artist] = [
        Line2D(
            [], [], color="0.3", linestyle="", marker="o", label=_said(resolution, label),
            markersize=_size(dataset, resolution, {resolution: label}),
        )
        for label in _order(dataset, resolution)
    ]  # fmt: skip
    return [
        colours,
        markers,
        [*sizes, *lines] if len(sizes) <= 2 else sizes,
        *([] if len(sizes) <= 2 else [lines]),
    ]


def _said(resolution: str, label: Any) -> str:
    """``cell size 0.2 m``; a label that is a text has its unit."""
    unit = " m" if resolution in _LENGTHS and not isinstance(label, str) else ""
    return f"{resolution.replace('_', ' ')} {label}{unit}"


def _legend(figure: Figure, rows: Sequence[Sequence[Artist]]) -> None:
    """Put the legend below the panels, a line for each row, as wide as the widest row needs."""
    columns = max(map(len, rows))
    entries = [
        row[k] if k < len(row) else Line2D([], [], linestyle="", label="")
        for k in range(columns)
        for row in rows
    ]
    figure.legend(
        handles=entries,
        loc="outside lower center",
        ncols=columns,
        fontsize=FONT - 2,
        frameon=False,
        columnspacing=0.8,
        handlelength=1.3,
        handletextpad=0.5,
    )


def _finest(problem: xr.Dataset, resolution: str | None) -> xr.Dataset:
    """The part of a problem at the finest resolution of which a cost is known."""
    if resolution is None:
        return problem
    parts = [problem.sel({resolution: label}) for label in _order(problem, resolution)[::-1]]
    return next((part for part in parts if np.isfinite(part["cpu_time"]).any()), parts[0]).expand_dims(
        resolution
    )


def _draw_bars(axes: Any, rows: list[dict[str, Any]], names: list[str]) -> None:
    left = np.zeros(len(rows))
    for name, colour in zip(names, itertools.cycle(_COLOURS), strict=False):
        widths = np.array([float(np.nan_to_num(row["run"]["stage_time"].sel(stage=name))) for row in rows])
        axes.barh(np.arange(len(rows)), widths, left=left, color=colour, label=name, height=0.72)
        left += widths
    labels = [", ".join(str(row[dim]) for dim in row["dims"] if dim in ("contact", "shape")) for row in rows]
    axes.set_yticks(np.arange(len(rows)), labels)
    for k, row in enumerate(rows):
        status = str(row["run"]["status"].item()).partition(":")[0]
        if status != "ok":
            axes.text(left[k], k, f" {status}", va="center", fontsize=FONT - 2)
