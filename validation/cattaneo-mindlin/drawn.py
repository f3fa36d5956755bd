"""The figure of the case: shear and pressure at half of the load that slides."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from pressed import FRICTION
from tractions import Tractions, half_way, of_forces, of_stress

from mpmfw.plots.style import dress, new_figure, on_lines
from mpmfw.validation import CaseRun

COLOURS = ("#0072B2", "#E69F00", "#009E73", "#7F3C8D", "#D55E00")
MARKERS = ("o", "s", "^", "D", "v")
#: Contacts that are drawn by stress.
OTHERS = ("penalty", "bardenhagen", "bardenhagen(criterion=position, normal=master)", "nairn")


def draw(runs: Sequence[CaseRun]) -> Figure:
    """Draw penalty contact by its forces at both cell sizes, and all methods by stress at the coarse one."""
    figure = new_figure(2, 1, 66.0)
    axes = figure.subplots(1, 2, sharey=True)
    penalty = [run for run in runs if str(run.method) == "penalty, cpdi"]
    for run, colour, marker in zip(penalty, COLOURS, MARKERS, strict=False):
        found = of_forces(run.results, half_way(run.results))
        peak = found.exact_pressure().max()
        _points(axes[0], found, found.pressure / peak, colour, marker, "none", f"p, {run.place.at}")
        _points(axes[0], found, found.shear / (FRICTION * peak), colour, marker, "full", f"q, {run.place.at}")
    _theory(axes[0], of_forces(penalty[-1].results, half_way(penalty[-1].results)), pressure=True)
    coarse = [run for run in runs if run.place.at == penalty[0].place.at]
    for contact, colour, marker in zip(OTHERS, COLOURS, MARKERS, strict=False):
        for run in (run for run in coarse if str(run.method) == f"{contact}, cpdi"):
            found = of_stress(run.results, half_way(run.results))
            bound = FRICTION * found.exact_pressure().max()
            _points(axes[1], found, found.shear / bound, colour, marker, "full", on_lines(contact))
    _theory(axes[1], of_stress(penalty[0].results, half_way(penalty[0].results)), pressure=False)
    titles = ("(a) penalty, from forces of surface nodes", f"(b) q from stresses, {penalty[0].place.at}")
    for panel, title, label in zip(axes, titles, ("p / p0, q / (μ p0) [1]", ""), strict=True):
        dress(panel, "x / a [1]", label, title)
        panel.set_xlim(-1.6, 1.6)
        panel.set_ylim(-0.25, 1.9)
        panel.legend(loc="upper center", ncols=2)
    return figure


def _points(
    panel: Any, found: Tractions, values: Any, colour: str, marker: str, fill: str, label: str
) -> None:
    panel.plot(
        found.x / found.half_width, values, color=colour, marker=marker, fillstyle=fill, markersize=3.5,
        linewidth=0.6, linestyle=":", label=label,
    )  # fmt: skip


def _theory(panel: Any, found: Tractions, *, pressure: bool) -> None:
    """The closed form with this run's c/a."""
    x = np.linspace(-1.0, 1.0, 801)
    arch = np.sqrt(1.0 - x**2)
    inner = np.sqrt(np.maximum(1.0 - (x / found.stick) ** 2, 0.0))
    panel.plot(x, arch - found.stick * inner, color="0.2", linewidth=1.0, label="Cattaneo, Mindlin")
    if pressure:
        panel.plot(x, arch, color="0.2", linewidth=1.0, linestyle="--", label="Hertz")
