"""Errors over the cell size."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from rolling import EXACT, NO_SLIP, SLIP, lumping_loss

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import Method

Errors = Mapping[float, Mapping[str, float]]

_BLUE, _LIGHT, _RED, _GREEN = "#0072B2", "#56B4E9", "#D55E00", "#117733"
_SLIP_LOOKS = {
    "displacement": ("o", "-", "displacement"),
    "acceleration": ("s", "--", "acceleration"),
    "angular acceleration": ("^", "-.", "angular acceleration"),
}


def convergence(
    found: Mapping[tuple[str, Method], Errors],
    elastic: Mapping[str, Mapping[str, float]],
    exact: Method,
    lumped: Method,
    classical: Sequence[Method],
) -> Figure:
    """No slip: sizes of errors on logarithmic axes; slip: errors with the values that they must tend to."""
    columns = 2 if (SLIP.name, exact) in found else 1
    figure = new_figure(columns, 1, 68.0)
    panels = figure.subplots(1, columns, squeeze=False)[0]
    methods = {
        "penalty": (found[NO_SLIP.name, exact], _BLUE, "o"),
        "penalty, lumped": (found[NO_SLIP.name, lumped], _LIGHT, "D"),
        **{
            method.contact: (found[NO_SLIP.name, method], colour, marker)
            for method, colour, marker in zip(classical, (_RED, _GREEN), ("s", "^"), strict=True)
        },
    }
    handles = _no_slip(panels[0], methods)
    if columns == 2:
        _slip(panels[1], found[SLIP.name, exact], elastic[SLIP.name])
    legend_below(figure, [handles] if columns == 2 else [handles[:3], handles[3:]])
    return figure


def _no_slip(axes: Any, methods: Mapping[str, tuple[Errors, str, str]]) -> list[Any]:
    handles = []
    for name, (errors, colour, marker) in methods.items():
        sizes = np.array(sorted(errors))
        values = [abs(errors[h]["displacement"]) for h in sizes]
        look = {"color": colour, "marker": marker, "markersize": 4, "linewidth": 1.1}
        handles += axes.loglog(sizes, values, **look, label=name)
    (exact, *_), (lumped, *_) = methods["penalty"], methods["penalty, lumped"]
    sizes = np.array(sorted(set(exact) & set(lumped)))
    loss = [exact[h]["acceleration"] - lumped[h]["acceleration"] for h in sizes]
    closed = 100.0 * lumping_loss(sizes, 0.5 * sizes) / 3.0
    handles += axes.plot(sizes, loss, "x", color="black", markersize=5, label="lost to lumping")
    handles += axes.plot(sizes, closed, **EXACT, label="ε/3")
    if len(sizes) > 2:
        _triangle(axes, 0.32, 0.012, 2.0)
    dress(axes, "cell size h [m]", "size of the error [%]", "no slip: displacement; lost to lumping")
    _ticks(axes, sizes)
    return handles


def _slip(axes: Any, errors: Errors, elastic: Mapping[str, float]) -> None:
    sizes = np.array(sorted(errors))
    for name, (marker, style, label) in _SLIP_LOOKS.items():
        values = [errors[h][name] for h in sizes]
        look = {"color": _BLUE, "marker": marker, "linestyle": style, "markersize": 4, "linewidth": 1.1}
        axes.semilogx(sizes, values, **look, label=label)
        axes.axhline(elastic[name], color="0.4", linestyle=style, linewidth=0.8, zorder=1)
    axes.axhline(0.0, **EXACT)
    axes.text(sizes[-1], 0.05, "rigid", ha="right", va="bottom")
    dress(axes, "cell size h [m]", "error [%]", "slip, penalty; grey: converged elastic solution")
    # Between the accelerations, where no curve runs
    axes.legend(loc="center", bbox_to_anchor=(0.5, 0.43))
    _ticks(axes, sizes)


def _ticks(axes: Any, sizes: Any) -> None:
    axes.set_xticks(sizes, [f"{h:g}" for h in sizes])
    axes.set_xticks([], minor=True)


def _triangle(axes: Any, left: float, bottom: float, order: float) -> None:
    """Slope of an order, over a factor of two in h."""
    right, top = 2.0 * left, bottom * 2.0**order
    axes.plot([left, right, right, left], [bottom, bottom, top, bottom], color="0.3", linewidth=0.8)
    axes.text(1.04 * right, np.sqrt(bottom * top), f"{order:g}", va="center", color="0.3")
    axes.text(np.sqrt(left * right), 0.93 * bottom, "1", va="top", ha="center", color="0.3")
