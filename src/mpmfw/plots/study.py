"""Error over CPU time with the Pareto front, and the time by stage."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from mpmfw.plots.costs import stages
from mpmfw.plots.study_grid import label_of, order_of, problems_of, resolution_of, runs_of, with_methods
from mpmfw.plots.style import Look, dress, entry, journal_style, legend_below, new_panels

#: Marker sizes [pt] of the coarsest and the finest resolution.
_SIZES = (5.5, 3.5)
#: Line of the error that a study asks for.
_LIMIT: dict[str, Any] = {"color": "0.55", "linewidth": 0.6, "linestyle": (0, (4, 3))}


def study_figures(dataset: xr.Dataset) -> dict[str, tuple[Figure, str]]:
    """Return the figures of a study, ``{name: (figure, caption)}``."""
    figures: dict[str, tuple[Figure, str]] = {}
    timing = dataset.attrs.get("timing", "")
    if (np.isfinite(dataset["error"]) & (dataset["error"] > 0) & np.isfinite(dataset["cpu_time"])).any():
        figures["front"] = (
            front(dataset),
            "Error over CPU time with the range of the repeats. The line joins filled runs, which no other "
            f"one beats in both. Timing: {timing}.{_failed(dataset)}",
        )
    if np.isfinite(dataset["stage_time"]).any():
        figures["stages"] = (stages(dataset), f"CPU time by stage of the step. Timing: {timing}.")
    return figures


@journal_style()
def front(dataset: xr.Dataset) -> Figure:
    """Draw error over CPU time of a study, a panel a problem, with the Pareto front; size is resolution."""
    named = with_methods(dataset)
    problems = list(problems_of(named))
    look, resolution = Look(named), resolution_of(named)
    figure, panels = new_panels(len(problems), 66.0, sharey=True)
    for axes, (title, problem) in zip(panels, problems, strict=True):
        _draw_front(axes, problem)
        for row in runs_of(problem):
            _draw_run(axes, row, look, _size(named, resolution, row))
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.margins(y=0.12)
        axes.axhline(100.0 * float(dataset.attrs["under"]), zorder=0, **_LIMIT)
        quantity = str(dataset.attrs["quantity"]).replace("-", " ")
        ylabel = f"error of {quantity} [%]" if axes is panels[0] else ""
        dress(axes, "CPU time [s]", ylabel, _title(title, problem))
        _plain_ticks(axes)
    key = _key(named, look, resolution)
    most = max(map(len, key))
    legend_below(figure, key, most=most, columnspacing=0.8, handlelength=1.3, handletextpad=0.5)
    return figure


def _size(dataset: xr.Dataset, resolution: str | None, row: dict[str, Any]) -> float:
    if resolution is None:
        return 5.0
    order = order_of(dataset, resolution)
    return float(np.interp(order.index(row[resolution]), (0, max(1, len(order) - 1)), _SIZES))


def _title(title: str, problem: xr.Dataset) -> str:
    without = sum(
        not np.isfinite(row["run"]["error"]) and str(row["run"]["status"].item()) != "ok"
        for row in runs_of(problem)
    )
    return f"{title} ({without} failed)" if without else title


def _failed(dataset: xr.Dataset) -> str:
    named = with_methods(dataset)
    failed = [
        ", ".join(str(row[dim]) for dim in row["dims"])
        for row in runs_of(named)
        if str(row["run"]["status"].item()) != "ok"
    ]
    return f" Without a result: {'; '.join(failed)}." if failed else ""


def _draw_run(axes: Any, row: dict[str, Any], look: Look, size: float) -> None:
    """Draw a run with the range of its repeats: filled and with a dark edge on the front, open else."""
    run, colour = row["run"], look.colours[row["contact"]]
    if not (np.isfinite(run["error"]) and run["error"] > 0.0 and np.isfinite(run["cpu_time"])):
        return  # a logarithmic axis cannot show it
    cost, spread = float(run["cpu_time"]), float(np.nan_to_num(run["cpu_time_spread"]))
    on = bool(run["pareto"])
    axes.errorbar(
        cost,
        100.0 * float(run["error"]),
        xerr=[[min(spread, 0.9 * cost)], [spread]],
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


def _key(dataset: xr.Dataset, look: Look, resolution: str | None) -> list[list[Artist]]:
    colours, _ = look.key()
    grey: dict[str, Any] = {"color": "0.3", "linestyle": "", "markersize": 5}
    markers = [entry(name, marker=marker, **grey) for name, (_, marker) in look.styles.items()]
    filled: dict[str, Any] = {"markerfacecolor": "0.6", "markeredgecolor": "black", "markersize": 4}
    lines = [
        entry("front", color="0.25", linewidth=0.9, marker="o", **filled),
        entry(f"{100.0 * float(dataset.attrs['under']):g} %", **_LIMIT),
    ]
    sizes = []
    for label in order_of(dataset, resolution) if resolution is not None else ():
        assert resolution is not None
        size = _size(dataset, resolution, {resolution: label})
        sizes.append(entry(label_of(resolution, label), marker="o", **grey | {"markersize": size}))
    return [colours, markers, [*sizes, *lines]] if len(sizes) <= 2 else [colours, markers, sizes, lines]
