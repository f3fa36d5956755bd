"""Figure of the case: the mirror error over time, and the contact stress along the interface."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from questions import BLUE, GREEN, ORANGE, REFERENCE, points_of
from symmetry import mirror_errors

from mpmfw.plots.style import dress, legend_below, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mpmfw.validation import CaseRun

#: Two passes; one with the first body of the scene as master, and one with the second.
#: Curves coincide: the first lies under the others.
LOOKS = ((BLUE, 2.0, "-"), (ORANGE, 1.3, (0, (4, 1.5))), (GREEN, 0.8, "-"))


def draw(runs: Sequence[CaseRun]) -> Figure:
    """Mirror error of the rings [h]; σ_yy/(−p) of the upper block's points nearest to the interface."""
    mirrors = [mirror_errors(run.results) for run in runs if run.runs == "rings"]
    coarse = [points_of(run.results) for run in runs if run.place.at == "upper segments 2h"]
    figure = new_figure(2, 1, 62.0)
    left, right = figure.subplots(1, 2)
    names = ("two passes", "one pass, first body master", "one pass, second body master")
    handles = []
    for (time, error), (colour, width, style) in zip(mirrors, LOOKS, strict=False):
        left.semilogy(1e3 * time, np.maximum(error, 1e-16), color=colour, linestyle=style, linewidth=width)
    left.set_xlim(0.0, 1e3 * max(time[-1] for time, _ in mirrors))
    left.axhline(0.01, **REFERENCE)
    left.text(left.get_xlim()[1], 0.0085, "0.01 h ", ha="right", va="top")
    left.set_ylim(1e-5, 1.0)
    dress(left, "time [ms]", "mirror error [h]", "(a) rings: asymmetry")
    for points, (colour, width, style), name in zip(coarse, LOOKS, names, strict=False):
        look = {
            "color": colour,
            "linewidth": width,
            "linestyle": style,
            "marker": "o",
            "markersize": 1.5 + 2.0 * width,
        }
        handles += right.plot(*points.row(upper=True), **look, fillstyle="none", label=name)
    right.axhline(1.0, **REFERENCE)
    dress(right, "x [m]", "stress σ_yy / (−p) [–]", "(b) blocks: lower segments h/4, upper 2h")
    legend_below(figure, [handles])
    return figure
