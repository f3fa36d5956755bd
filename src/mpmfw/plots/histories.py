"""Figures of series over time: of one run, of several runs, of a comparison."""

from __future__ import annotations

import itertools
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from mpmfw.errors import SceneError
from mpmfw.plots.field_figure import labelled
from mpmfw.plots.style import (
    PANEL,
    Look,
    combinations,
    count_in,
    dress,
    entry,
    head,
    journal_style,
    legend_below,
    new_panels,
    scaled_label,
    time_scale,
)
from mpmfw.results.analysis import without_round_off
from mpmfw.results.selection import Results, checked_name, opened, series_of
from mpmfw.state.fields import FloatArray

#: Width of a legend below one panel, in letters.
_LETTERS = 52
#: Panels that a page holds.
_MOST = 24
_CYCLE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_STYLES: tuple[Any, ...] = ("-", "--", "-.", ":")
_EXACT: dict[str, Any] = {"color": "black", "linewidth": 0.8, "zorder": 5}
_THIN: dict[str, Any] = {"linewidth": 0.5, "alpha": 0.6}


@dataclass(frozen=True)
class RunSeries:
    """Series of one run, and how its lines look."""

    label: str
    series: xr.Dataset
    look: dict[str, Any]


@dataclass(frozen=True)
class Curve:
    """A curve of a series: of a body or a pair, along an axis."""

    name: str
    choice: tuple[tuple[str, Any], ...]

    @property
    def label(self) -> str:
        """``cylinder, x``; empty for a series of the whole run."""
        return ", ".join(str(value) for _, value in self.choice)

    def of(self, series: xr.Dataset) -> FloatArray:
        """Its values over the time; NaN where a run does not have it."""
        try:
            return np.asarray(series[self.name].sel(dict(self.choice)).values, dtype=float)
        except KeyError:
            return np.full(series.sizes["time"], np.nan)


@dataclass(frozen=True)
class Panel:
    """One curve of several runs, and of the reference."""

    curve: Curve
    sources: Sequence[RunSeries]
    title: str
    exact: tuple[FloatArray, FloatArray] | None = None


@journal_style()
def history(
    results: Results | Mapping[str, Results] | Sequence[Results],
    names: str | Sequence[str],
    *,
    body: str | None = None,
    pair: str | None = None,
    axis: str | None = None,
) -> Figure:
    """Draw series over time.

    Parameters
    ----------
    results
        A run, with a panel for each series; several runs, or a comparison, with a panel for each series, body
        and axis.
    names
        Series: ``min_gap``, ``centre_of_mass`` …
    body, pair, axis
        Only this one; ``axis`` also chooses among the components of a rotation.

    Raises
    ------
    SceneError
        There is no such series, body, pair or axis, or there would be too many panels.
    """
    if isinstance(results, str | os.PathLike):
        with opened(results) as read:  # the series alone, not the frames
            series = series_of(read)
            results = series if isinstance(read, xr.Dataset) else xr.DataTree.from_dict({"series": series})
    selection = {"body": body, "pair": pair, "axis": axis}
    if isinstance(results, xr.Dataset):
        panels, key = _compared(without_round_off(results), names, selection)
        figure = _drawn(panels, results)
        legend_below(figure, key)
        return figure
    runs = _runs(results)
    curves = _curves([run.series for run in runs], names, selection)
    if len(runs) == 1:
        return _of_one(runs[0], curves)
    figure = _drawn([Panel(curve, runs, curve.label) for curve in curves])
    _legend(figure, [entry(run.label, **run.look) for run in runs])
    return figure


#: A series, its unit, and times and values of its reference.
Beside = tuple[xr.DataArray, str, FloatArray, FloatArray]


@journal_style()
def beside_reference(
    comparisons: Sequence[tuple[xr.Dataset, str, Mapping[str, Beside]]], label: str, noisy: str = ""
) -> Figure:
    """Draw series of ``comparisons`` and their reference, ``label``; a ``noisy`` series has thin lines."""
    panels, keys = [], []
    for dataset, title, series in comparisons:
        arrays = {
            name: array.reset_coords(drop=True).assign_attrs(units=unit)
            for name, (array, unit, _, _) in series.items()
        }
        drawn, key = _compared(without_round_off(dataset.assign(arrays)), list(series), {})
        keys.append(key)
        for panel in drawn:
            runs = panel.sources
            if panel.curve.name == noisy:
                runs = [replace(run, look={"color": run.look["color"], **_THIN}) for run in runs]
            panels.append(Panel(panel.curve, runs, title, series[panel.curve.name][2:]))
    figure = _drawn(panels, comparisons[0][0] if len(comparisons) == 1 else None)
    key = max(keys, key=lambda rows: sum(map(len, rows)))
    if any(len(times) for _, _, series in comparisons for _, _, times, _ in series.values()):
        key[0].insert(0, entry(label, **_EXACT))
    legend_below(figure, key)
    return figure


def _of_one(source: RunSeries, curves: Sequence[Curve]) -> Figure:
    """Draw a run: a panel for each series, colours and styles for its curves."""
    names = list(dict.fromkeys(curve.name for curve in curves))
    looks, key = _looks(curves)
    figure, grid = _figure(len(names))
    for axes, name in zip(grid, names, strict=True):
        for curve in curves:
            if curve.name == name:
                look = {"linewidth": 1.1, **looks.get(curve.label, {"color": "black"})}
                _draw(axes, source.series, curve, look)
        _dress(axes, [source], name, "")
    if key:
        _legend(figure, key)
    return figure


def _looks(curves: Sequence[Curve]) -> tuple[dict[str, dict[str, Any]], list[Artist]]:
    colours: dict[Any, str] = {}
    styles: dict[Any, Any] = {}
    looks = {}
    for curve in curves:
        if curve.choice:
            (_, first), *rest = curve.choice
            along = ", ".join(str(value) for _, value in rest)
            looks[curve.label] = {
                "color": colours.setdefault(first, _CYCLE[len(colours) % len(_CYCLE)]),
                "linestyle": styles.setdefault(along, _STYLES[len(styles) % len(_STYLES)]) if along else "-",
            }
    key = [entry(name, color=colour, linewidth=2.5) for name, colour in colours.items()]
    return looks, key + [entry(name, color="0.3", linestyle=style) for name, style in styles.items()]


def _legend(figure: Figure, entries: Sequence[Artist]) -> None:
    longest = max(len(str(one.get_label())) for one in entries)
    most = max(1, int(_LETTERS * figure.get_figwidth() / PANEL / (longest + 8)))
    legend_below(figure, [entries[k : k + most] for k in range(0, len(entries), most)])


def _drawn(panels: Sequence[Panel], compared: xr.Dataset | None = None) -> Figure:
    figure, grid = _figure(len(panels))
    if compared is not None:
        head(figure, compared)
    for axes, panel in zip(grid, panels, strict=True):
        for source in panel.sources:
            _draw(axes, source.series, panel.curve, source.look)
        if panel.exact is not None:
            axes.plot(*panel.exact, **_EXACT)
        _dress(axes, panel.sources, panel.curve.name, panel.title)
    return figure


def _figure(panels: int) -> tuple[Figure, list[Any]]:
    if panels > _MOST:
        raise SceneError(f"{panels} panels, of {_MOST} at most; choose a body, a pair or an axis")
    return new_panels(panels, 58.0 if panels <= 2 else 48.0)


def _draw(axes: Any, series: xr.Dataset, curve: Curve, look: Mapping[str, Any]) -> None:
    values = curve.of(series)
    if np.isfinite(values).any():
        axes.plot(series["time"].values, values, **look)


def _dress(axes: Any, sources: Sequence[RunSeries], name: str, label: str) -> None:
    last = max(float(source.series["time"].values[-1]) for source in sources)
    scale, unit = time_scale(last)
    count_in(axes.xaxis, 1.0 / scale)
    own = next(source.series[name] for source in sources if name in source.series)
    words = scaled_label(axes.yaxis, name.replace("_", " "), own.attrs.get("units", "1"))
    dress(axes, f"time [{unit}]", words, label)


def _runs(results: Any) -> list[RunSeries]:
    with labelled(results) as trees:
        series = {label: without_round_off(series_of(tree)) for label, tree in trees.items()}
    runs = []
    for k, (label, data) in enumerate(series.items()):
        if data.sizes.get("time", 0) < 2:
            raise SceneError(f"{label or 'the run'}: no series with two outputs or more")
        look = {"color": _CYCLE[k % len(_CYCLE)], "linestyle": _STYLES[k % len(_STYLES)], "linewidth": 1.1}
        runs.append(RunSeries(label, data, look))
    return runs


def _compared(
    dataset: xr.Dataset, names: str | Sequence[str], selection: Mapping[str, str | None]
) -> tuple[list[Panel], list[list[Artist]]]:
    if not {"contact", "shape"} <= set(dataset.dims) or dataset.sizes.get("time", 0) < 2:
        kind = dataset.attrs.get("kind", "")
        raise SceneError(f"these results{f' of a {kind!r}' if kind else ''} hold no series over time to draw")
    look, points = Look(dataset), dataset.sizes["time"]
    curves = _curves([dataset.isel(dict.fromkeys(dataset["status"].dims, 0))], names, selection)
    runs, drawn = [], []
    for turn, (contact, shape, run) in enumerate(combinations(dataset)):
        runs.append(RunSeries(f"{contact}, {shape}", run, look.line(contact, shape, points, turn)))
        if any(np.isfinite(curve.of(run)).any() for curve in curves):
            drawn.append((contact, shape))
    key = look.key({contact for contact, _ in drawn}, {shape for _, shape in drawn})
    return [Panel(curve, runs, curve.label) for curve in curves], key


def _curves(
    series: Sequence[xr.Dataset], names: str | Sequence[str], selection: Mapping[str, str | None]
) -> list[Curve]:
    names = [names] if isinstance(names, str) else names
    if not names:
        raise SceneError("no series named")
    known = {str(name): one for data in reversed(series) for name, one in data.data_vars.items()}
    known = {name: one for name, one in known.items() if "time" in one.dims}
    arrays = {name: known[checked_name("series", name, sorted(known))] for name in names}
    for kind, label in selection.items():
        along = ("axis", "rotation") if kind == "axis" else (kind,)
        having = [(array, dim) for array in arrays.values() for dim in along if dim in array.dims]
        if label is not None and not having:
            raise SceneError(f"{kind} '{label}': has no effect, since {', '.join(arrays)} has no {kind}")
        for array, dim in having if label is not None else ():
            checked_name(kind, str(label), [str(value) for value in array[dim].values])
    found = []
    for name, array in arrays.items():
        dims = tuple(str(dim) for dim in array.dims if dim != "time")
        chosen = [selection.get("axis" if dim == "rotation" else dim) for dim in dims]
        labels = [
            [value for value in array[dim].values.tolist() if label in (None, value)]
            for dim, label in zip(dims, chosen, strict=True)
        ]
        found += [Curve(name, tuple(zip(dims, one, strict=True))) for one in itertools.product(*labels)]
    return found
