"""Figures of steep friction: growth and error over friction, and the maps over friction and tilt."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from measures import Measured

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import Method

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Row = tuple[Method | str, list[Measured]]

GREYS = {0.1: "#B8B8B8", 0.05: "#7A7A7A", 1.0 / 30.0: "#000000"}

#: Beginning of the name: name in the figure, colour, line, marker.
LOOKS: dict[str, tuple[str, str, Any, str]] = {
    "finite elements, springs, 50 mm": ("finite elements, springs, 50 mm", "#000000", "-", "s"),
    "finite elements, no springs, 50 mm": ("finite elements, no springs, 50 mm", "#7A7A7A", "--", "D"),
    "penalty, cpdi": ("penalty, 100 mm", "#0072B2", "-", "o"),
    "penalty, cpdi, h = 0.05": ("penalty, 50 mm", "#56B4E9", "-", "^"),
    "penalty, cpdi, flip, 5 % pic, h = 0.05": ("penalty with 5 % PIC, 50 mm", "#009E73", "-.", "v"),
    "bardenhagen, cpdi, normal master, h = 0.05": ("bardenhagen, master, 50 mm", "#7F3C8D", ":", "P"),
}

NAMES = {
    "finite elements, springs, 50 mm": "(a) finite elements, springs",
    "finite elements, no springs, 50 mm": "(b) finite elements, no springs",
    "penalty, cpdi": "(c) penalty",
    "penalty, cpdi, flip, 5 % pic": "(d) penalty with 5 % PIC",
    "bardenhagen, cpdi": "(e) bardenhagen",
    "bardenhagen, cpdi, normal master": "(f) bardenhagen, master",
    "bardenhagen, cpdi, normal master, criterion position": "(g) bardenhagen, master, position",
}
BOUNDS = (0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 1e9)  # of |error| [%]
STAYS, CREEPS = "#F4F4F4", "#FFB000"
COLOURS = ("#2166AC", "#67A9CF", "#D1E5F0", "#FDDBC7", "#EF8A62", "#B2182B")


def draw_chatter(
    modes: Mapping[tuple[str, float], np.ndarray],
    grown: Sequence[tuple[str, float, float]],
    steep: Sequence[Row],
    sliding_limit: float,
) -> Figure:
    """Growth of the lowest mode over friction, and error of the acceleration at 40 degrees over friction."""
    figure = new_figure(2, 1, 68.0)
    left, right = figure.subplots(1, 2)
    left.legend(handles=_draw_growth(left, modes, grown), loc="upper left")
    handles = _draw_errors(right, steep, sliding_limit)
    legend_below(figure, [handles[k : k + 3] for k in range(0, len(handles), 3)])
    return figure


def _draw_growth(
    axes: Any, modes: Mapping[tuple[str, float], np.ndarray], grown: Sequence[tuple[str, float, float]]
) -> list[Line2D]:
    handles = []
    for (contact, size), rates in modes.items():
        look: dict[str, Any] = {
            "color": GREYS[size],
            "linestyle": "-" if contact == "springs" else "--",
            "linewidth": 1.2,
        }
        known = rates if len(rates) > 3 else rates[1:]  # no line from zero to the first of few points
        axes.plot(*known.T, **look)
        name = "springs" if contact == "springs" else "no springs"
        handles.append(Line2D([], [], label=f"finite elements, {name}, {1e3 * size:.0f} mm", **look))
    for size, colour in (("0.1", "#0072B2"), ("0.05", "#56B4E9")):
        at = [(mu, rate) for h, mu, rate in grown if h == size]
        if at:
            look = {
                "color": colour,
                "marker": "o" if size == "0.1" else "^",
                "linestyle": "",
                "markersize": 5.5,
            }
            axes.plot(*np.transpose(at), **look, zorder=5)
            handles.append(Line2D([], [], label=f"penalty, {1e3 * float(size):.0f} mm", **look))
    axes.set_xlim(0.0, None)
    axes.set_ylim(0.0, 190.0)  # room for the legend
    dress(
        axes,
        "friction coefficient μ [–]",
        "growth rate of the lowest mode [s⁻¹]",
        "(a) small motions about sliding",
    )
    return handles


def _draw_errors(axes: Any, steep: Sequence[Row], sliding_limit: float) -> list[Line2D]:
    handles = []
    for method, found in steep:
        if str(method) not in LOOKS:
            continue
        name, colour, style, marker = LOOKS[str(method)]
        found = sorted(found, key=lambda one: one.friction)
        look = {"color": colour, "linestyle": style, "linewidth": 1.1, "marker": marker, "markersize": 4.0}
        error = [max(abs(one.error), 2e-3) for one in found]
        axes.semilogy([one.friction for one in found], error, **look)
        handles.append(Line2D([], [], label=name, **look))
    axes.axhline(1.0, color="k", linewidth=0.8)
    axes.axvline(sliding_limit, color="k", linewidth=0.8, linestyle=":")
    axes.annotate(
        "sticks",
        (sliding_limit, 3e-3),
        xytext=(-3, 0),
        textcoords="offset points",
        ha="right",
        rotation=90,
    )
    dress(axes, "friction coefficient μ [–]", "|error of the acceleration| [%]", "(b) block at 40°")
    return handles


def draw_map(rows: Sequence[Row], creep: float) -> Figure:
    """A panel a method: the error of the acceleration where the block slides, and whether it stays where it sticks."""
    figure = new_figure(2, 4, 44.0)
    panels = figure.subplots(4, 2, sharex=True, sharey=True)
    for axes, (method, found) in zip(panels.flat, rows, strict=False):
        _draw_cells(axes, found, creep)
        dress(axes, "tilt θ [°]", "friction coefficient μ [–]", NAMES[str(method)])
        axes.grid(False)
        axes.label_outer()
    panels[2, 1].tick_params(labelbottom=True)
    panels[2, 1].set_xlabel("tilt θ [°]")
    names = ["below 0.1 %", "0.1 to 0.3 %", "0.3 to 1 %", "1 to 3 %", "3 to 10 %", "above 10 %"]
    keys = [_key(colour, name) for colour, name in zip(COLOURS, names, strict=True)]
    keys += [_key(STAYS, "sticks, as it must"), _key(CREEPS, "must stick, and creeps")]
    panels[3, 1].axis("off")
    title = "error of the acceleration [%], numbers in cells;\nblack line: tan θ = μ"
    panels[3, 1].legend(
        handles=keys,
        title=title,
        loc="center",
        ncols=2,
    )
    return figure


def _draw_cells(axes: Any, found: Sequence[Measured], creep: float) -> None:
    """Fill a panel, and write the error [%] or the speed of creep into each cell."""
    frictions, tilts = (sorted({getattr(one, key) for one in found}) for key in ("friction", "tilt"))
    colours, norm = ListedColormap(COLOURS), BoundaryNorm(BOUNDS, len(COLOURS))
    for one in found:
        i, j = tilts.index(one.tilt), frictions.index(one.friction)
        size = abs(one.error) if one.slides else 0.0
        face = colours(norm(size)) if one.slides else STAYS if one.speed < creep else CREEPS
        axes.add_patch(Rectangle((i - 0.5, j - 0.5), 1.0, 1.0, facecolor=face, edgecolor="w", linewidth=0.8))
        colour = "w" if one.slides and (size >= 10.0 or size < 0.1) else "k"
        axes.text(i, j, _said(one, creep), ha="center", va="center", color=colour)
    _draw_border(axes, [[math.tan(tilt) > friction for friction in frictions] for tilt in tilts])
    axes.set_xlim(-0.5, len(tilts) - 0.5)
    axes.set_ylim(-0.5, len(frictions) - 0.5)
    axes.set_xticks(range(len(tilts)), [f"{math.degrees(tilt):.0f}" for tilt in tilts])
    axes.set_yticks(range(len(frictions)), [f"{friction:g}" for friction in frictions])


def _draw_border(axes: Any, slides: Sequence[Sequence[bool]]) -> None:
    """Draw the edges between cells where the rigid block slides, (tilts, frictions), and those where it sticks."""
    for i, column in enumerate(slides):
        for j, here in enumerate(column):
            if j + 1 < len(column) and here != column[j + 1]:
                axes.plot((i - 0.5, i + 0.5), (j + 0.5, j + 0.5), "k-", linewidth=1.4)
            if i + 1 < len(slides) and here != slides[i + 1][j]:
                axes.plot((i + 0.5, i + 0.5), (j - 0.5, j + 0.5), "k-", linewidth=1.4)


def _said(one: Measured, creep: float) -> str:
    if not one.slides:
        return "stick" if one.speed < creep else f"{1e3 * one.speed:.0f} mm/s"
    digits = 0 if abs(one.error) >= 10.0 else 1 if abs(one.error) >= 1.0 else 2
    told = f"{one.error:+.{digits}f}"
    return "0.00" if told in ("+0.00", "-0.00") else told.replace("-", "−")


def _key(colour: str, name: str) -> Line2D:
    return Line2D(
        [],
        [],
        color=colour,
        marker="s",
        markersize=7,
        markeredgecolor="0.5",
        markeredgewidth=0.4,
        linestyle="",
        label=name,
    )
