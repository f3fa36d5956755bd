"""The figures of the case."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from noise import Found

from mpmfw.plots.style import dress, legend_below, new_figure

SHIPPED = "scene as shipped"
#: Colour and marker of what is varied, by the beginning of the label; the first that fits.
GROUPS: dict[str, tuple[str, str, str]] = {
    "damping": ("#0072B2", "o", "contact damping, κ = 0.25"),
    "kappa": ("#D55E00", "s", "stiffness κ, with and without damping"),
    "segments": ("#CC79A7", "v", "segments"),
    "": ("#009E73", "^", "transfer"),
}
#: Where numbers stand beside their points [pt]; of the others up and right.
PLACES = {
    "damping 0.3": (-8, -3),
    "damping 1": (4, -5),
    "kappa 1": (-8, 1),
    "kappa 1, damping 0.3": (-7, -9),
    "kappa 1, damping 1": (5, -3),
    "tpic": (3, -8),
    "segments of 0.5 h": (-12, -7),
}
HISTORIES = ("", "damping 1", "kappa 0.1, damping 1", "apic", "flip, 10 % pic", "kappa 1")


def against_loss(results: Mapping[str, Found], elements: Mapping[str, Found]) -> Figure:
    """Noise of the force, and its error over 100 µs, over the energy that is lost; a point for each variant."""
    figure = new_figure(2, 1, 78.0)
    panels = figure.subplots(1, 2)
    numbers = {label: str(k) for k, label in enumerate(results, start=1)}
    for axes, value in zip(panels, (_noise, _error), strict=True):
        for label, found in results.items():
            colour, marker, _ = _group(label)
            axes.plot(100.0 * found.lost, value(found), marker, color=colour, markersize=4)
            axes.annotate(
                numbers[label],
                (100.0 * found.lost, value(found)),
                xytext=PLACES.get(label, (3, 3)),
                textcoords="offset points",
            )
        axes.set_xscale("log")
        axes.set_xticks([5, 10, 20, 40, 80], ["5", "10", "20", "40", "80"])
        axes.minorticks_off()
        axes.set_xlim(3.8, 110.0)
        axes.margins(y=0.1)
    panels[0].axhline(elements["fine"].noise, color="black", linewidth=1.0)
    for axes, value in zip(panels, (_noise, _error), strict=True):
        axes.axhline(value(elements["coarse"]), color="0.5", linestyle="--", linewidth=1.0)
    dress(panels[0], "energy lost [% of the start]", "noise [–]", "(a) noise of the force")
    dress(
        panels[1], "energy lost [% of the start]", "relative L2 error", "(b) error of the force over 100 µs"
    )
    legend_below(figure, _key(numbers))
    return figure


def _noise(found: Found) -> float:
    return found.noise


def _error(found: Found) -> float:
    return found.errors[100]


def _group(label: str) -> tuple[str, str, str]:
    if not label:
        return "black", "D", SHIPPED
    return next(look for start, look in GROUPS.items() if label.startswith(start))


def _key(numbers: Mapping[str, str]) -> list[list[Line2D]]:
    """Lines, and each number with what it stands for in the colour of its group."""
    entries = []
    for label, number in numbers.items():
        colour, marker, _ = _group(label)
        entries.append(_entry(f"{number}: {label or SHIPPED}", color=colour, marker=marker, linestyle=""))
    rows = [entries[k : k + 4] for k in range(0, len(entries), 4)]
    fine = _entry("finite elements, 0.5 mm", color="black", linewidth=1.0)
    coarse = _entry("finite elements, 2 mm", color="0.5", linestyle="--", linewidth=1.0)
    return [[fine, coarse], *rows]


def _entry(label: str, **look: Any) -> Line2D:
    return Line2D([], [], label=label, markersize=4, **look)


def histories(results: Mapping[str, Found], fine: Found) -> Figure:
    """Raw force of some variants over that of the fine finite elements."""
    shown = [label for label in HISTORIES if label in results]
    rows = (len(shown) + 1) // 2
    figure = new_figure(2, rows, 46.0)
    panels = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
    for axes in panels.flat[len(shown) :]:
        axes.set_visible(False)
    for axes, letter, label in zip(panels.flat, "abcdef", shown, strict=False):
        colour, _, _ = _group(label)
        axes.plot(1e3 * fine.time, 1e-3 * fine.force, color="0.6", linewidth=0.9)
        own = "#0072B2" if not label else colour
        axes.plot(1e3 * results[label].time, 1e-3 * results[label].force, color=own, linewidth=0.9)
        lost = f"{100.0 * results[label].lost:.0f} % of the energy lost"
        dress(axes, "time [ms]", "force [kN/m]", f"({letter}) {label or SHIPPED}, {lost}")
        axes.label_outer()
        axes.set_xlim(0.0, 3.2)
    legend_below(
        figure,
        [
            [
                _entry("finite elements, 9-node, 0.5 mm", color="0.6", linewidth=0.9),
                _entry("penalty, CPDI", color="black", linewidth=0.9),
            ]
        ],
    )
    return figure
