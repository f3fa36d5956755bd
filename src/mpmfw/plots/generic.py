"""Figures that any scene has: gap, centre of mass, velocity, energies, contact force."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpmfw.plots.style import Look, combinations, dress, head, journal_style, legend_below, new_figure
from mpmfw.plots.units import scaled_label
from mpmfw.results.references import cell_size

_PANELS = (
    ("centre_of_mass", "centre of mass", "body"),
    ("mean_velocity", "velocity", "body"),
    ("kinetic_energy", "kinetic energy", "body"),
    ("strain_energy", "strain energy", "body"),
    ("contact_force", "contact force", "pair"),
    ("min_gap", "gap", "pair"),
)
#: Top of the gap's history, in cells.
LARGEST_GAP = 3.0
_CYCLE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")


@journal_style()
def gap_history(dataset: xr.Dataset) -> Figure:
    """Least distance between the surfaces of the first pair, in cells where the cell size is known.

    Parameters
    ----------
    dataset
        A comparison, or the series of a run, with ``min_gap`` [m].
    """
    figure = new_figure(1, 1)
    head(figure, dataset)
    axes = figure.subplots()
    look, time = Look(dataset), dataset["time"].values
    unit, scale = "gap [m]", 1.0 if time[-1] > 0.1 else 1e3
    for turn, (contact, shape, run) in enumerate(combinations(dataset)):
        h = cell_size(run)
        unit = "gap / cell size" if h > 0.0 else "gap [m]"
        gap = run["min_gap"].isel(pair=0).values / (h if h > 0.0 else 1.0)
        if not np.isfinite(gap).any():
            continue
        axes.plot(scale * time, gap, **look.line(contact, shape, len(time), turn))
    axes.axhline(0.0, color="black", linewidth=0.6)
    dress(axes, "time [s]" if scale == 1.0 else "time [ms]", unit)
    if unit != "gap [m]":  # bodies that have flown apart would hide what happens in contact
        axes.set_ylim(top=min(axes.get_ylim()[1], LARGEST_GAP))
    axes.set_xlim(scale * time[0], scale * time[-1])
    legend_below(figure, look.key())
    return figure


@journal_style()
def series_overview(dataset: xr.Dataset) -> Figure:
    """Series of a run or a comparison, one panel for each; a run's bodies and pairs by colour.

    Of vectors the component along the axis where there is most of it: of the way, the velocity, the force.

    Parameters
    ----------
    dataset
        A comparison, or the series of a run.
    """
    present = [panel for panel in _PANELS if panel[0] in dataset]
    figure = new_figure(2, (len(present) + 1) // 2, 48.0)
    head(figure, dataset)
    panels = figure.subplots((len(present) + 1) // 2, 2, squeeze=False).ravel()
    compared = "contact" in dataset.dims
    for axes, (name, label, over) in zip(panels, present, strict=False):
        series = dataset[name]
        if "axis" in series.dims:
            main = _main_axis(series)
            series, label = series.sel(axis=main), f"{label}, {main}"
        if compared:
            _draw_compared(axes, dataset.assign({name: series}), name, over)
            label = f"{label}\n({dataset[over].values[0]})"
        else:
            _draw_run(axes, dataset, series, over)
        dress(axes, "time [s]", scaled_label(axes.yaxis, label, dataset[name].attrs.get("units", "1")))
    for axes in panels[len(present) :]:
        axes.remove()
    legend_below(figure, Look(dataset).key() if compared else [_run_key(dataset)])
    return figure


def _draw_compared(axes: Any, dataset: xr.Dataset, name: str, over: str) -> None:
    look, time = Look(dataset), dataset["time"].values
    for turn, (contact, shape, run) in enumerate(combinations(dataset)):
        values = run[name].isel({over: 0}).values
        axes.plot(time, values, **look.line(contact, shape, len(time), turn))


def _draw_run(axes: Any, dataset: xr.Dataset, series: xr.DataArray, over: str) -> None:
    colours = _colours(dataset)
    for label in dataset[over].values.tolist():
        values = series.sel({over: label}).values
        axes.plot(dataset["time"].values, values, color=colours[label], linewidth=1.1)


def _main_axis(series: xr.DataArray) -> str:
    """The axis along which a vector is largest at any time, a position counted from where it starts."""
    sizes = abs(series - series.isel(time=0) if series.name == "centre_of_mass" else series)
    largest = sizes.max([dim for dim in sizes.dims if dim != "axis"]).fillna(0.0)
    return str(series["axis"].values[int(largest.argmax("axis"))])


def _colours(dataset: xr.Dataset) -> dict[str, str]:
    labels = [
        label for dim in ("body", "pair") if dim in dataset.coords for label in dataset[dim].values.tolist()
    ]
    return {label: _CYCLE[i % len(_CYCLE)] for i, label in enumerate(labels)}


def _run_key(dataset: xr.Dataset) -> list[Artist]:
    return [
        Line2D([], [], color=colour, linewidth=2.0, label=label)
        for label, colour in _colours(dataset).items()
    ]
