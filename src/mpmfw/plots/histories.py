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

from mpmfw.errors import SceneError
from mpmfw.plots import style
from mpmfw.plots.field_figure import labelled
from mpmfw.results.analysis import without_round_off
from mpmfw.results.selection import Results, checked_name, opened, series_of
from mpmfw.state.fields import FloatArray

#: Panels that a page holds.
_MOST = 24
_STYLES: tuple[Any, ...] = ("-", "--", "-.", ":")
_EXACT: dict[str, Any] = {"color": "black", "linewidth": 0.8, "zorder": 5}
_THIN: dict[str, Any] = {"linewidth": 0.5, "alpha": 0.6}


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
        """Its values over time; NaN if a run does not have it."""
        try:
            return np.asarray(series[self.name].sel(dict(self.choice)).values, dtype=float)
        except KeyError:
            return np.full(series.sizes["time"], np.nan)


@dataclass(frozen=True)
class Panel:
    """Curves of one series, and of the reference."""

    name: str  #: of the series
    lines: Sequence[tuple[xr.Dataset, Curve, dict[str, Any]]]  #: with the look of each
    title: str = ""
    exact: tuple[FloatArray, FloatArray] | None = None


@style.journal_style()
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
        style.legend_below(figure, key)
        return figure
    with labelled(results) as trees:
        runs = {label: without_round_off(series_of(tree)) for label, tree in trees.items()}
    for label, series in runs.items():
        if series.sizes.get("time", 0) < 2:
            raise SceneError(f"{label or 'the run'}: no series with two outputs or more")
    curves = _curves(list(runs.values()), names, selection)
    panels, key = (_of_one if len(runs) == 1 else _of_several)(runs, curves)
    figure = _drawn(panels)
    if any(key):
        style.legend_below(figure, key)
    return figure


#: A series, its unit, and times and values of its reference.
Beside = tuple[xr.DataArray, str, FloatArray, FloatArray]


@style.journal_style()
def beside_reference(
    dataset: xr.Dataset, series: Mapping[str, Beside], label: str, *, title: str = "", noisy: str = ""
) -> Figure:
    """Draw ``series`` of a comparison and their reference, ``label``; a ``noisy`` series has thin lines."""
    arrays = {
        name: array.reset_coords(drop=True).assign_attrs(units=unit)
        for name, (array, unit, _, _) in series.items()
    }
    drawn, key = _compared(without_round_off(dataset.assign(arrays)), list(series), {})
    panels = []
    for panel in drawn:
        lines = panel.lines
        if panel.name == noisy:
            lines = [(run, curve, {"color": look["color"], **_THIN}) for run, curve, look in lines]
        panels.append(Panel(panel.name, lines, title, series[panel.name][2:]))
    figure = _drawn(panels, dataset)
    if any(len(times) for _, _, times, _ in series.values()):
        key[0].insert(0, style.entry(label, **_EXACT))
    style.legend_below(figure, key)
    return figure


def _of_one(
    runs: Mapping[str, xr.Dataset], curves: Sequence[Curve]
) -> tuple[list[Panel], list[list[Artist]]]:
    """Return a panel for each series of a run, with colours and styles for its curves."""
    colours: dict[Any, str] = {}
    styles: dict[Any, Any] = {}
    lines: dict[str, list[Any]] = {}
    for curve in curves:
        look = {"linewidth": 1.1, "color": "black"}
        if curve.choice:
            (_, first), *rest = curve.choice
            look["color"] = colours.setdefault(first, style.CYCLE[len(colours) % len(style.CYCLE)])
            if along := ", ".join(str(value) for _, value in rest):
                look["linestyle"] = styles.setdefault(along, _STYLES[len(styles) % len(_STYLES)])
        lines.setdefault(curve.name, []).extend((series, curve, look) for series in runs.values())
    solid = [style.entry(name, color=colour, linewidth=2.5) for name, colour in colours.items()]
    dashed = [style.entry(name, color="0.3", linestyle=dashes) for name, dashes in styles.items()]
    return [Panel(name, of_name) for name, of_name in lines.items()], [solid, dashed]


def _of_several(
    runs: Mapping[str, xr.Dataset], curves: Sequence[Curve]
) -> tuple[list[Panel], list[list[Artist]]]:
    """Return a panel for each curve, with a look for each run."""
    colours, styles = itertools.cycle(style.CYCLE), itertools.cycle(_STYLES)
    looks = {label: {"color": next(colours), "linestyle": next(styles), "linewidth": 1.1} for label in runs}
    panels = [
        Panel(curve.name, [(runs[label], curve, look) for label, look in looks.items()], curve.label)
        for curve in curves
    ]
    return panels, [[style.entry(label, **look) for label, look in looks.items()]]


def _drawn(panels: Sequence[Panel], compared: xr.Dataset | None = None) -> Figure:
    if len(panels) > _MOST:
        raise SceneError(f"{len(panels)} panels, of {_MOST} at most; choose a body, a pair or an axis")
    figure, grid = style.new_panels(len(panels), 58.0 if len(panels) <= 2 else 48.0)
    if compared is not None:
        style.head(figure, compared)
    for axes, panel in zip(grid, panels, strict=True):
        for series, curve, look in panel.lines:
            values = curve.of(series)
            if np.isfinite(values).any():
                axes.plot(series["time"].values, values, **look)
        if panel.exact is not None:
            axes.plot(*panel.exact, **_EXACT)
        scale, unit = style.time_scale(max(float(series["time"].values[-1]) for series, _, _ in panel.lines))
        style.count_in(axes.xaxis, 1.0 / scale)
        stored = next(series[panel.name] for series, _, _ in panel.lines if panel.name in series)
        words = style.scaled_label(axes.yaxis, panel.name.replace("_", " "), stored.attrs.get("units", "1"))
        style.dress(axes, f"time [{unit}]", words, panel.title)
    return figure


def _compared(
    dataset: xr.Dataset, names: str | Sequence[str], selection: Mapping[str, str | None]
) -> tuple[list[Panel], list[list[Artist]]]:
    if not {"contact", "shape"} <= set(dataset.dims) or dataset.sizes.get("time", 0) < 2:
        kind = dataset.attrs.get("kind", "")
        raise SceneError(f"these results{f' of a {kind!r}' if kind else ''} hold no series over time to draw")
    look, points = style.Look(dataset), dataset.sizes["time"]
    curves = _curves([dataset.isel(dict.fromkeys(dataset["status"].dims, 0))], names, selection)
    runs, drawn = [], []
    for turn, (contact, shape, run) in enumerate(style.combinations(dataset)):
        runs.append((run, look.line(contact, shape, points, turn)))
        if any(np.isfinite(curve.of(run)).any() for curve in curves):
            drawn.append((contact, shape))
    key = look.key({contact for contact, _ in drawn}, {shape for _, shape in drawn})
    panels = [Panel(one.name, [(run, one, line) for run, line in runs], one.label) for one in curves]
    return panels, key


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
