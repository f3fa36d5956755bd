"""The figure of the case: what the point of contact has along the plane before the impact and after it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from bounce import impact
from elastic import CHI, psi, rebound
from thrown import FRICTION

from mpmfw.plots.style import dress, legend_below, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mpmfw.validation import CaseRun

#: Methods by the start of their names: what the legend calls them, colour and marker.
LOOKS = {
    "penalty, ": ("penalty", "#0072B2", "o"),
    "bardenhagen, ": ("bardenhagen", "#D55E00", "s"),
    "bardenhagen(": ("its strongest form", "#E69F00", "^"),
}


def draw(runs: Sequence[CaseRun]) -> Figure:
    """ψ2 over ψ1 of Maw, Barber and Fawcett, the rigid limits, and every run; coarse cells hollow, fine ones filled."""
    figure = new_figure(1, 1, 66.0)
    axes = figure.subplots()
    slopes = np.linspace(0.05, 3.2, 64)
    angles = psi(slopes)
    theory = axes.plot(
        angles,
        [psi(s) * rebound(float(s), 200, 1000) for s in slopes],
        color="0.2",
        linewidth=1.0,
        label="elastic",
    )
    rigid = np.minimum(angles, 4.0 * CHI), np.maximum(angles - 4.0 * CHI, 0.0)
    theory += axes.plot(angles, rigid[1], color="0.2", linewidth=1.0, linestyle="--", label="rigid")
    cells = sorted({run.place.make["cells"] for run in runs})
    shown = {}
    for run in runs:
        label, colour, marker = next(
            look for start, look in LOOKS.items() if str(run.method).startswith(start)
        )
        found = impact(run.results)
        fine = run.place.make["cells"] == cells[-1] and len(cells) > 1
        (line,) = axes.plot(
            psi(found["slope"]), psi(found["slope"]) * found["contact"], color=colour, marker=marker,
            fillstyle="full" if fine else "none", markersize=5, linestyle="", label=label,
        )  # fmt: skip
        shown.setdefault(label, line)
    dress(axes, f"ψ1 of μ = {FRICTION:g} [1]", "ψ2 [1]")
    axes.set_ylim(-2.8, 2.6)
    legend_below(figure, [theory, list(shown.values())])
    return figure
