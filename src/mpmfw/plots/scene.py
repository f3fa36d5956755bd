"""Figures of a comparison on any scene: where its bodies went, what acted between them, and where its energy is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpmfw.plots.generic import LARGEST_GAP
from mpmfw.plots.style import (
    PANEL,
    Look,
    at_last,
    combinations,
    dress,
    head,
    journal_style,
    legend_below,
    new_figure,
)
from mpmfw.plots.units import length_scale, scaled_label, time_scale
from mpmfw.results.references import cell_size

#: Bodies by colour, in the scene's order; those that move no further than this part of what moves most are grey.
_BODIES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_STILL = 1e-2
#: Pairs and bodies of which a figure has a row; of more those with the largest forces, and that move furthest.
MOST = 6
#: Panels beside each other that a page holds at column width.
MOST_ACROSS = 3


def travel(dataset: xr.Dataset) -> xr.DataArray:
    """Largest displacement of every body's centre of mass over runs and outputs [m], by body."""
    centre = dataset["centre_of_mass"].transpose("body", "axis", "time", ...)
    away = (centre - centre.isel(time=0)).values
    size = np.sqrt((away**2).sum(axis=1)).reshape(len(away), -1)
    known = np.where(np.isfinite(size), size, 0.0)
    return xr.DataArray(known.max(axis=1), {"body": dataset["body"]}, ("body",))


def moving_bodies(dataset: xr.Dataset) -> list[str]:
    """Bodies that do not stand still in every run, those that move furthest first."""
    far = travel(dataset)
    return [
        str(name)
        for name in far["body"].values[np.argsort(-far.values, kind="stable")]
        if far.sel(body=name) > _STILL * far.max()
    ]


def touching_pairs(dataset: xr.Dataset) -> list[str]:
    """Pairs with a contact force in any run, largest first."""
    force = np.abs(dataset["contact_force"].transpose("pair", ...).values).reshape(dataset.sizes["pair"], -1)
    largest = np.where(np.isfinite(force), force, 0.0).max(axis=1)
    return [str(dataset["pair"].values[k]) for k in np.argsort(-largest, kind="stable") if largest[k] > 0.0]


def near_pairs(dataset: xr.Dataset) -> list[str]:
    """Pairs whose gap is in the figure in any run: within so many cells, where their size is known."""
    h = cell_size(at_last(dataset))
    least = at_last(dataset)["min_gap"].transpose("pair", ...).values.reshape(dataset.sizes["pair"], -1)
    near = (least < (LARGEST_GAP * h if h > 0.0 else np.inf)).any(axis=1)
    return [str(name) for name in dataset["pair"].values[near]]


@journal_style()
def start_and_end(dataset: xr.Dataset) -> Figure:
    """Outlines of all bodies at the first output (dashed) and at the last, one panel for each method, all at one scale.

    Parameters
    ----------
    dataset
        Comparison with ``outline``.
    """
    runs = [one for one in combinations(dataset) if np.isfinite(one[2]["outline"].values).any()]
    points = np.concatenate([run["outline"].values.reshape(-1, 2) for _, _, run in runs])
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    margin = 0.04 * (high - low).max()
    scale, unit = length_scale(float((high - low).max()))
    ratio = float((high - low + 2.0 * margin)[1] / (high - low + 2.0 * margin)[0])
    columns = 1 if len(runs) == 1 else 2
    rows = -(-len(runs) // columns)
    figure = new_figure(columns, rows, min(22.0 * PANEL * ratio, 110.0) + 17.0)
    figure.set_layout_engine("compressed")
    head(figure, dataset)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    colours = _body_colours(dataset)
    for axes, (contact, shape, run) in zip(panels, runs, strict=False):
        for frame, style in (("last", "-"), ("first", (0, (3, 3)))):
            for name, line in zip(
                run["outlined_body"].values, run["outline"].sel(frame=frame).values, strict=True
            ):
                axes.plot(*(scale * line).T, color=colours[str(name)], linestyle=style, linewidth=0.9)
        time, shown = time_scale(float(run["outline_time"].sel(frame="last")))
        axes.set_aspect("equal")
        axes.set_xlim(*(scale * (low[0] - margin), scale * (high[0] + margin)))
        axes.set_ylim(*(scale * (low[1] - margin), scale * (high[1] + margin)))
        last = f"{time * float(run['outline_time'].sel(frame='last')):.4g} {shown}"
        dress(axes, f"x [{unit}]", f"y [{unit}]", f"{contact}, {shape}, {last}")
        axes.grid(False)
    for axes in panels[len(runs) :]:
        axes.remove()
    legend_below(
        figure, [[*_key(colours), Line2D([], [], color="0.3", linestyle=(0, (3, 3)), label="start")]]
    )
    return figure


@journal_style()
def pair_forces(dataset: xr.Dataset) -> Figure:
    """Size of the normal and the tangential force of every pair that touches, one row each."""
    names = ("normal force", "tangential force") if "friction_force" in dataset else ("contact force",)
    unit = dataset["contact_force"].attrs.get("units", "N")

    def parts(run: xr.Dataset, pair: str) -> list[Any]:
        force = run["contact_force"].sel(pair=pair)
        if "friction_force" not in run:
            return [_size(force)]
        along = run["friction_force"].sel(pair=pair)
        return [_size(force - along), _size(along)]

    figure, _ = _histories(dataset, touching_pairs(dataset)[:MOST], [(name, unit) for name in names], parts)
    return figure


@journal_style()
def pair_gaps(dataset: xr.Dataset) -> Figure:
    """Least distance of the bodies of every pair that comes near, in cells; below zero they overlap."""
    h = cell_size(at_last(dataset))

    def parts(run: xr.Dataset, pair: str) -> list[Any]:
        return [run["min_gap"].sel(pair=pair).values / (h if h > 0.0 else 1.0)]

    columns = [("gap", "cells" if h > 0.0 else "m")]
    figure, panels = _histories(dataset, near_pairs(dataset)[:MOST], columns, parts)
    for axes in panels.ravel():
        axes.axhline(0.0, color="black", linewidth=0.6)
        if h > 0.0:  # bodies that have flown apart would hide what happens in contact
            axes.set_ylim(top=min(axes.get_ylim()[1], LARGEST_GAP))
    return figure


@journal_style()
def body_motion(dataset: xr.Dataset) -> Figure:
    """Displacement of the centre of mass along every axis and, where there is one, the spin of each body that moves."""
    directions = [str(name) for name in dataset["axis"].values]
    rotations = [str(name) for name in dataset["rotation"].values] if "angular_velocity" in dataset else []
    columns = [(f"displacement, {name}", "m") for name in directions]
    columns += [("spin" if len(rotations) == 1 else f"spin, {name}", "rad/s") for name in rotations]

    def parts(run: xr.Dataset, body: str) -> list[Any]:
        centre = run["centre_of_mass"].sel(body=body)
        moved = [(centre - centre.isel(time=0)).sel(axis=name).values for name in directions]
        return moved + [run["angular_velocity"].sel(body=body, rotation=name).values for name in rotations]

    figure, _ = _histories(dataset, moving_bodies(dataset)[:MOST], columns, parts)
    return figure


@journal_style()
def energies(dataset: xr.Dataset) -> Figure:
    """Kinetic and strain energy of all bodies, and what friction, dashpots and contact springs took, over time."""
    unit = dataset["kinetic_energy"].attrs.get("units", "J")
    lost = [name for name in ("frictional_work", "damping_work", "spring_work") if name in dataset]
    names = ("kinetic energy", "strain energy", "dissipated")[: 2 + bool(lost)]

    def parts(run: xr.Dataset, _row: str) -> list[Any]:
        sums = [run[name].sum("body", skipna=False).values for name in ("kinetic_energy", "strain_energy")]
        works = [run[name].fillna(0.0).sum("pair").values for name in lost]
        return [*sums, *([np.where(np.isfinite(sums[0]), np.sum(works, axis=0), np.nan)] if works else [])]

    figure, _ = _histories(dataset, [""], [(name, unit) for name in names], parts)
    return figure


def _histories(
    dataset: xr.Dataset,
    rows: Sequence[str],
    columns: Sequence[tuple[str, str]],
    parts: Callable[[xr.Dataset, str], Sequence[Any]],
) -> tuple[Figure, Any]:
    """Curves of every run over time: one row of panels for each of ``rows``, with one panel for each series of ``parts``.

    ``columns`` are the panels' titles and units.
    """
    across = min(len(columns), MOST_ACROSS)
    lines = len(rows) * -(-len(columns) // across)
    figure = new_figure(across, lines, 42.0)
    head(figure, dataset)
    panels = figure.subplots(lines, across, squeeze=False, sharex=True)
    last_line = panels[-1]
    for axes in panels.reshape(len(rows), -1)[:, len(columns) :].ravel():
        axes.remove()
    panels = panels.reshape(len(rows), -1)[:, : len(columns)]
    look, time = Look(dataset), dataset["time"].values
    factor, second = time_scale(float(time[-1]))
    for line, row in zip(panels, rows, strict=True):
        for turn, (contact, shape, run) in enumerate(combinations(dataset)):
            for axes, values in zip(line, parts(run, row), strict=True):
                axes.plot(factor * time, values, **look.line(contact, shape, len(time), turn))
        for axes, (title, unit) in zip(line, columns, strict=True):
            label = scaled_label(axes.yaxis, title, unit)
            dress(axes, f"time [{second}]" if axes in last_line else "", label, row)
            axes.set_xlim(factor * time[0], factor * time[-1])
    legend_below(figure, look.key())
    return figure, panels


def _size(force: xr.DataArray) -> Any:
    return np.sqrt((force.transpose("time", "axis").values ** 2).sum(axis=1))


def _body_colours(dataset: xr.Dataset) -> dict[str, str]:
    moving = set(moving_bodies(dataset))
    names = [str(name) for name in dataset["body"].values]
    turn = iter(_BODIES * (1 + len(names) // len(_BODIES)))
    return {name: next(turn) if name in moving else "0.45" for name in names}


def _key(colours: dict[str, str]) -> list[Artist]:
    return [Line2D([], [], color=colour, linewidth=2.0, label=name) for name, colour in colours.items()]
