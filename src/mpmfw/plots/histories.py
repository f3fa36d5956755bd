"""Figures of series over time: of one run, of several runs, of a comparison."""

from __future__ import annotations

import itertools
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpmfw.errors import SceneError
from mpmfw.plots.field_figure import labelled
from mpmfw.plots.style import PANEL, Look, combinations, dress, head, journal_style, legend_below, new_figure
from mpmfw.plots.units import count_in, scaled_label, time_scale
from mpmfw.results.outputs import Results, checked_name, opened, series_of
from mpmfw.results.round_off import without_round_off

#: Letters of a legend that fit below one panel.
_LETTERS = 52
#: Panels that a page holds.
_MOST = 24
_CYCLE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
_STYLES: tuple[Any, ...] = ("-", "--", "-.", ":")


@dataclass(frozen=True)
class RunSeries:
    """Series of one run, and how its lines look."""

    label: str
    series: xr.Dataset
    look: dict[str, Any]


@dataclass(frozen=True)
class Curve:
    """One of the curves that a series holds: of a body or a pair, along an axis."""

    name: str
    choice: tuple[tuple[str, Any], ...]

    @property
    def label(self) -> str:
        """``cylinder, x``; empty for a series of the whole run."""
        return ", ".join(str(value) for _, value in self.choice)

    def of(self, series: xr.Dataset) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Its values over the time; NaN where a run does not have it."""
        nothing = np.full(series.sizes["time"], np.nan)
        if self.name not in series:
            return nothing
        array = series[self.name]
        if any(value not in array[dim].values for dim, value in self.choice):
            return nothing
        return np.asarray(array.sel(dict(self.choice)).values, dtype=float)


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
        A run, whose bodies, pairs and axes are told apart by colour in one panel a series; several runs, or a
        comparison, whose runs are told apart by colour and style in one panel for each series, body and axis.
    names
        Series: ``min_gap``, ``centre_of_mass`` …
    body, pair, axis
        Only this one; ``axis`` also chooses among the components of a rotation.

    Raises
    ------
    SceneError
        There is no such series, body, pair or axis, or too many panels would be needed.
    """
    if isinstance(results, str | os.PathLike):
        with opened(results) as read:  # the series alone, not the frames
            series = series_of(read).load()
            results = series if isinstance(read, xr.Dataset) else xr.DataTree.from_dict({"series": series})
    found, key, compared = _sources(results)
    selection = [names] if isinstance(names, str) else list(names)
    curves = _curves(
        [source.series for source in found], selection, {"body": body, "pair": pair, "axis": axis}
    )
    if len(found) == 1 and not compared:
        return _of_one(found[0], curves)
    return _of_several(found, curves, key, compared)


def _of_one(source: RunSeries, curves: Sequence[Curve]) -> Figure:
    """One panel a series, a colour for each body or pair, a style for each axis."""
    names = list(dict.fromkeys(curve.name for curve in curves))
    looks, key = _looks(curves)
    panels = {name: [curve for curve in curves if curve.name == name] for name in names}
    figure, grid = _figure(len(panels))
    for axes, (name, own) in zip(grid, panels.items(), strict=True):
        for curve in own:
            _draw(
                axes, source.series, curve, {"linewidth": 1.1, **looks.get(curve.label, {"color": "black"})}
            )
        _dress(axes, [source], name, "")
    if key:
        _legend(figure, key)
    return figure


def _looks(curves: Sequence[Curve]) -> tuple[dict[str, dict[str, Any]], list[Artist]]:
    """Colour and style by label, and the legend: a colour for each body or pair, a style for each axis."""
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
    key: list[Artist] = [
        Line2D([], [], color=colour, linewidth=2.5, label=name) for name, colour in colours.items()
    ]
    key += [Line2D([], [], color="0.3", linestyle=style, label=name) for name, style in styles.items()]
    return looks, key


def _legend(figure: Figure, entries: Sequence[Artist]) -> None:
    """As many entries in a line as their labels leave room for."""
    longest = max(len(str(entry.get_label())) for entry in entries)
    most = max(1, int(_LETTERS * figure.get_figwidth() / PANEL / (longest + 8)))
    legend_below(figure, [entries[k : k + most] for k in range(0, len(entries), most)])


def _of_several(
    sources: Sequence[RunSeries],
    curves: Sequence[Curve],
    key: list[list[Artist]],
    compared: xr.Dataset | None,
) -> Figure:
    """One panel for each curve, a colour or style for each run."""
    figure, grid = _figure(len(curves))
    if compared is not None:
        head(figure, compared)
    for axes, curve in zip(grid, curves, strict=True):
        for source in sources:
            _draw(axes, source.series, curve, source.look)
        _dress(axes, sources, curve.name, curve.label)
    if compared is None:
        _legend(figure, key[0])
    else:
        legend_below(figure, key)
    return figure


def _figure(panels: int) -> tuple[Figure, list[Any]]:
    if panels > _MOST:
        raise SceneError(
            f"{panels} panels would be needed, at most {_MOST} fit; choose a body, a pair or an axis"
        )
    columns = min(2, panels)
    rows = -(-panels // columns)
    figure = new_figure(columns, rows, 58.0 if rows == 1 else 48.0)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes in grid[panels:]:
        axes.remove()
    return figure, list(grid[:panels])


def _draw(axes: Any, series: xr.Dataset, curve: Curve, look: Mapping[str, Any]) -> None:
    values = curve.of(series)
    if np.isfinite(values).any():
        axes.plot(series["time"].values, values, **look)


def _dress(axes: Any, sources: Sequence[RunSeries], name: str, label: str) -> None:
    """Labels with units; times in ms where all are short."""
    last = max(float(source.series["time"].values[-1]) for source in sources)
    scale, unit = time_scale(last)
    count_in(axes.xaxis, 1.0 / scale)
    own = next(source.series[name] for source in sources if name in source.series)
    words = scaled_label(axes.yaxis, name.replace("_", " "), own.attrs.get("units", "1"))
    dress(axes, f"time [{unit}]", words, label)


def _sources(results: Any) -> tuple[list[RunSeries], list[list[Artist]], xr.Dataset | None]:
    """The runs to draw, the rows of their legend, and the comparison that they are of."""
    if isinstance(results, xr.Dataset):
        return _compared(without_round_off(results))
    with labelled({"": results} if isinstance(results, xr.DataTree) else results) as trees:
        series = {label: without_round_off(series_of(tree).load()) for label, tree in trees.items()}
    found = []
    for k, (label, data) in enumerate(series.items()):
        if data.sizes.get("time", 0) < 2:
            raise SceneError(f"{label or 'the run'}: no series with two outputs or more")
        look = {"color": _CYCLE[k % len(_CYCLE)], "linestyle": _STYLES[k % len(_STYLES)], "linewidth": 1.1}
        found.append(RunSeries(label, data, look))
    return found, [[Line2D([], [], label=one.label, **one.look) for one in found]], None


def _compared(dataset: xr.Dataset) -> tuple[list[RunSeries], list[list[Artist]], xr.Dataset]:
    if not {"contact", "shape"} <= set(dataset.dims) or dataset.sizes.get("time", 0) < 2:
        kind = dataset.attrs.get("kind", "")
        raise SceneError(f"these results{f' of a {kind!r}' if kind else ''} hold no series over time to draw")
    look = Look(dataset)
    points = dataset.sizes["time"]
    found = [
        RunSeries(f"{contact}, {shape}", run, look.line(contact, shape, points, turn))
        for turn, (contact, shape, run) in enumerate(combinations(dataset))
    ]
    return found, look.key(), dataset


def _curves(
    series: Sequence[xr.Dataset], names: Sequence[str], selection: Mapping[str, str | None]
) -> list[Curve]:
    """Every curve of the series that the choice leaves.

    Raises
    ------
    SceneError
        A name is unknown, or a choice is of nothing that the series have.
    """
    if not names:
        raise SceneError("no series named")
    known = {
        str(name): array
        for data in reversed(series)
        for name, array in data.data_vars.items()
        if "time" in array.dims
    }
    arrays = {name: known[checked_name("series", name, sorted(known))] for name in names}
    for kind, label in selection.items():
        if label is not None:
            _check_choice(kind, label, arrays)
    found = []
    for name, array in arrays.items():
        dims = [str(dim) for dim in array.dims if dim != "time"]
        labels = [
            [value for value in array[dim].values.tolist() if _choice(dim, selection) in (None, value)]
            for dim in dims
        ]
        found += [Curve(name, tuple(zip(dims, one, strict=True))) for one in itertools.product(*labels)]
    return found


def _choice(dim: str, selection: Mapping[str, str | None]) -> str | None:
    return selection.get("axis" if dim == "rotation" else dim)


def _check_choice(kind: str, label: str, arrays: Mapping[str, xr.DataArray]) -> None:
    dims = ("axis", "rotation") if kind == "axis" else (kind,)
    having = [(name, dim) for name, array in arrays.items() for dim in dims if dim in array.dims]
    if not having:
        raise SceneError(f"{kind} '{label}': has no effect, since {', '.join(arrays)} has no {kind}")
    for name, dim in having:
        checked_name(kind, label, [str(value) for value in arrays[name][dim].values])
