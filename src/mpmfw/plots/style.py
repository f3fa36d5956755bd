"""Looks of figures: a colour for each contact method, a line style for each shape function, and units."""

from __future__ import annotations

import itertools
import re
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mpmfw.plugin.discovery import Kind, available, distribution_of
from mpmfw.results.references import Reference, reference_of
from mpmfw.results.selection import points_of
from mpmfw.results.stored_scene import own_attributes

#: Width of one panel [inch]: 85 mm, a journal's column.
PANEL = 85.0 / 25.4
#: Width of a figure of two columns or more [inch]: 175 mm, a journal's page.
PAGE = 175.0 / 25.4
#: Height that a figure has for a legend below its panels [inch].
LEGEND = 0.45

#: Of bodies, or of runs, in their order.
CYCLE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
#: Of the installed contacts and shape functions in their order: a method looks the same in every figure.
_COLOURS = (
    "#117733", "#D55E00", "#AA4499", "#56B4E9", "#8C564B", "#7F3C8D", "#B2B200", "#DDAA33", "#CC79A7",
    "#009E73", "#6B6B6B", "#0072B2", "#A0A0A0",
)  # fmt: skip
_STYLES: tuple[tuple[Any, str], ...] = (
    ((0, (5, 1, 1, 1, 1, 1)), "v"),
    ((0, (1, 1)), "h"),
    ("-", "o"),
    ("-.", "D"),
    ((0, (3, 1, 1, 1)), "p"),
    ("--", "^"),
    (":", "s"),
)
#: Of methods with options, and of those that are more than the looks.
_SPARE = ("#E69F00", "#17BECF", "#F781BF", "#332288", "#000000", "#4DAF4A", "#882255")
_SPARE_STYLES: tuple[tuple[Any, str], ...] = (((0, (8, 2)), "P"), ((0, (1, 3)), "X"))


def installed(kind: Kind) -> list[str]:
    """Return the methods of a kind: mpmfw's own, then others."""
    found = available(kind)
    return sorted(found, key=lambda name: (distribution_of(found[name]) != "mpmfw", name))


@contextmanager
def journal_style() -> Iterator[None]:
    """Context, or decorator, of the style sheet ``mpmfw.plots.journal``."""
    with rc_context(fname=Path(__file__).with_name("journal.mplstyle")):
        yield


class _Figure(Figure):
    """Figure that is drawn with the style sheet: matplotlib reads some settings late."""

    @journal_style()
    def draw(self, renderer: RendererBase) -> None:
        super().draw(renderer)


@journal_style()
def new_figure(columns: int, rows: int, height: float = 58.0) -> Figure:
    """Return a figure for ``columns`` × ``rows`` panels of ``height`` [mm]."""
    figure = _Figure(figsize=(PANEL if columns == 1 else PAGE, rows * height / 25.4 + LEGEND))
    FigureCanvasAgg(figure)
    return figure


def new_panels(count: int, height: float, most: int = 2, **options: Any) -> tuple[Figure, list[Any]]:
    """Return a figure of ``count`` panels of ``height`` [mm], at most ``most`` in a row."""
    columns = min(most, count)
    rows = -(-count // columns)
    figure = new_figure(columns, rows, height)
    grid = figure.subplots(rows, columns, squeeze=False, **options).ravel()
    for axes in grid[count:]:
        axes.remove()
    return figure, list(grid[:count])


def dress(axes: Any, xlabel: str, ylabel: str, title: str = "") -> None:
    """Label one panel; of several each has a letter, unless its title begins with one."""
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.grid(visible=True)
    panels = [one for one in axes.figure.axes if one.get_subplotspec() is not None]
    wanted = len(panels) > 1 and axes in panels and not re.match(r"\([a-z]\)", title)
    letter = f"({chr(ord('a') + panels.index(axes))}) " if wanted else ""
    if letter or title:
        axes.set_title(letter + on_lines(title))


def on_lines(text: str) -> str:
    """Return a text whose options have lines of at most 30 letters."""
    return re.sub(r"(?<=\w)\((?=\w+=)[^)]*\)", lambda options: "\n" + textwrap.fill(options[0], 30), text)


class Look:
    """Colours and styles of the combinations of one comparison."""

    def __init__(self, dataset: xr.Dataset) -> None:
        self.contacts = [str(name) for name in dataset["contact"].values] if "contact" in dataset.dims else []
        self.shapes = [str(name) for name in dataset["shape"].values] if "shape" in dataset.dims else []
        spare, spare_styles = itertools.cycle(_SPARE), itertools.cycle(_SPARE_STYLES)
        colours = dict(zip(installed("contact"), _COLOURS, strict=False))
        styles = dict(zip(installed("shape"), _STYLES, strict=False))
        self.colours = {name: colours.get(name) or next(spare) for name in self.contacts}
        self.styles = {name: styles.get(name) or next(spare_styles) for name in self.shapes}

    def line(self, contact: str, shape: str, points: int, turn: int) -> dict[str, Any]:
        """Return keywords of ``Axes.plot``; ``turn`` shifts the markers."""
        style, marker = self.styles[shape]
        every = max(1, points // 8)
        return {
            "color": self.colours[contact],
            "linestyle": style,
            "marker": marker,
            "markersize": 3.0,
            "markevery": ((turn * every) // 5 % every, every),
            "linewidth": 1.1,
        }

    def key(
        self, contacts: Iterable[str] | None = None, shapes: Iterable[str] | None = None
    ) -> list[list[Artist]]:
        """Return rows of the legend: colours of contacts, styles of shapes."""
        colours = [
            entry(name, color=colour, linewidth=2.5)
            for name, colour in self.colours.items()
            if contacts is None or name in contacts
        ]
        look: dict[str, Any] = {"color": "0.3", "markersize": 3, "linewidth": 1.1}
        styles = [
            entry(name, linestyle=style, marker=marker, **look)
            for name, (style, marker) in self.styles.items()
            if shapes is None or name in shapes
        ]
        return [colours, styles]


def entry(label: str, **look: Any) -> Artist:
    """Return a line of a legend."""
    return Line2D([], [], label=label, **look)


def varied_dims(dataset: xr.Dataset) -> list[str]:
    """Return the dimensions of a comparison that are varied keys."""
    dims = dataset["status"].dims if "status" in dataset else ()
    return [str(dim) for dim in dims if dim not in ("contact", "shape")]


def at_last(dataset: xr.Dataset) -> xr.Dataset:
    """Return a comparison at the last value of each varied key."""
    return dataset.isel(dict.fromkeys(varied_dims(dataset), -1))


def drawn_reference(dataset: xr.Dataset) -> Reference | None:
    """Return the reference of a comparison's figures."""
    return reference_of(own_attributes(at_last(dataset)))


def drawn_values(dataset: xr.Dataset) -> str:
    """Return ``cell_size = 0.8 (last of 0.4, 0.8)`` for each varied key."""
    return "; ".join(
        f"{dim} = {values[-1]} (last of {', '.join(map(str, values))})"
        for dim in varied_dims(dataset)
        if len(values := dataset[dim].values.tolist()) > 1
    )


def head(figure: Figure, dataset: xr.Dataset) -> None:
    """Write above the panels which of the varied values are drawn."""
    text = drawn_values(dataset)
    if text:
        figure.suptitle(textwrap.fill(text, round(28 * figure.get_figwidth())))


def combinations(dataset: xr.Dataset) -> Iterator[tuple[str, str, xr.Dataset]]:
    """Yield (contact, shape, results) of a comparison."""
    for labels, run in points_of(at_last(dataset), ("contact", "shape")):
        yield str(labels["contact"]), str(labels["shape"]), run


def legend_below(
    figure: Figure, rows: Sequence[Sequence[Artist]], most: int | None = None, **look: float
) -> None:
    """Put the legend below the panels, each row of entries on new lines; the figure grows by these."""
    if figure.get_figwidth() <= PANEL:
        for one in itertools.chain(*rows):
            one.set_label(on_lines(str(one.get_label())))
    longest = max(map(len, rows))
    columns = min(longest, most or 4 * round(figure.get_figwidth() / PANEL))
    columns = -(-longest // -(-longest // columns))  # no line with a single entry
    for count in range(columns, 0, -1):
        lines = [row[k : k + count] for row in rows for k in range(0, len(row), count)]
        blank = entry("", linestyle="")
        filled = [[*line, *[blank] * (count - len(line))] for line in lines]
        labels = [_equally_high([str(one.get_label()) for one in line]) for line in filled]
        legend = figure.legend(
            list(itertools.chain(*zip(*filled, strict=True))),  # matplotlib fills columns
            list(itertools.chain(*zip(*labels, strict=True))),
            loc="outside lower center",
            ncols=count,
            **look,
        )
        extent = legend.get_window_extent()
        if count == 1 or extent.width <= figure.bbox.width:
            figure.set_figheight(figure.get_figheight() + max(extent.height / figure.dpi - LEGEND, 0.0))
            return
        legend.remove()


def _equally_high(labels: list[str]) -> list[str]:
    most = max(label.count("\n") for label in labels)
    lacking = [most - label.count("\n") for label in labels]
    return ["\n" * (k // 2) + label + "\n" * (k - k // 2) for label, k in zip(labels, lacking, strict=True)]


_LARGE = ((1e9, "G"), (1e6, "M"), (1e3, "k"))
_SMALL = ((1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
#: Units with large and with small prefixes; others have none.
_WITH_LARGE, _WITH_SMALL = ("Pa", "N", "J", "W"), ("N", "J", "W", "m")


def readable(unit: str) -> str:
    """Return a CF unit as a fraction: ``kg m s-1 m-1`` as ``kg m/(s m)``."""
    over: list[str] = []
    under: list[str] = []
    for part in unit.split():
        name, sign, power = part.partition("-")
        (under if sign else over).append(f"{name}{power}" if power not in ("", "1") else name)
    over = [part for part in over if part != "1"]
    if not under:
        return " ".join(over)
    below = under[0] if len(under) == 1 else f"({' '.join(under)})"
    return f"{' '.join(over) or '1'}/{below}"


def with_prefix(unit: str, largest: float) -> tuple[float, str]:
    """Return the size of a shown unit, and its name, such as kPa or mm."""
    first = unit.partition(" ")[0]
    prefixes: tuple[tuple[float, str], ...] = _LARGE if first in _WITH_LARGE and largest >= 1.0 else ()
    if first in _WITH_SMALL and (first != "m" or unit == "m") and 0.0 < largest < 0.1:
        prefixes = _SMALL
    for size, prefix in prefixes:
        if largest >= size:
            return size, readable(prefix + unit)
    return 1.0, readable(unit)


def scaled_label(axis: Any, words: str, unit: str) -> str:
    """Return ``words [unit]`` of an axis whose ticks it counts in that unit."""
    curves = [np.abs(np.asarray(line.get_ydata(), float)) for line in axis.axes.get_lines()]
    largest = max((np.nanmax(curve) for curve in curves if np.isfinite(curve).any()), default=0.0)
    size, shown = with_prefix(unit, float(largest))
    count_in(axis, size)
    return in_brackets(words, shown)


def count_in(axis: Any, size: float) -> None:
    """Show ticks of a matplotlib axis in units of ``size``."""
    if size != 1.0:
        axis.set_major_formatter(lambda value, _: f"{value / size:.6g}".replace("-", "\N{MINUS SIGN}"))


def in_brackets(label: str, unit: str) -> str:
    """Return ``label [unit]``, or the label alone without a unit."""
    return f"{label} [{unit}]" if unit else label


def time_scale(last: float) -> tuple[float, str]:
    """Return the factor and the unit of times up to ``last`` [s]."""
    return (1.0, "s") if last >= 0.1 else (1e3, "ms")


def length_scale(extent: float) -> tuple[float, str]:
    """Return the factor and the unit of a drawing of this extent [m]."""
    return (1.0, "m") if extent >= 0.5 else (1e3, "mm")
