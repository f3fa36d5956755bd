"""The figure of the case: what the point of contact has along the plane before the impact and after it."""

from collections.abc import Sequence

import numpy as np
from bounce import impact
from elastic import psi, rebound, sliding_from
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from spheres import SPHERES

from mpmfw.plots.style import dress, entry, legend_below, new_figure
from mpmfw.validation import CaseRun

#: Colours and markers of contacts.
LOOKS = {
    "penalty": ("#0072B2", "o"),
    "bardenhagen": ("#D55E00", "s"),
    "bardenhagen(criterion=position, normal=master)": ("#E69F00", "^"),
}
#: Spheres of the panels, and how they hit the plane.
PANELS = {"5 steel": "obliquely", "6 nylon": "turning"}


def draw(runs: Sequence[CaseRun]) -> Figure:
    """Draw ψ2 over ψ1 of Maw, Barber and Fawcett, the rigid limits, and all runs; coarse cells hollow."""
    figure = new_figure(2, 1, 66.0)
    for axes, (test, done) in zip(figure.subplots(1, 2, sharey=True), PANELS.items(), strict=True):
        theory = _theory(axes, SPHERES[test].poisson)
        for run in runs:
            if run.place.make["test"] == test and "their speed" not in run.place.at:
                _mark(axes, run)
        sphere = SPHERES[test]
        what = f"{test.split()[1].capitalize()}, {done}: ν = {sphere.poisson:g}, μ = {sphere.friction:g}"
        after = "after it, ψ2 [1]" if test == "5 steel" else ""
        dress(axes, "tangential velocity before the impact, ψ1 [1]", after, what)
    plain = {"linestyle": "", "markersize": 5}
    contacts = [entry(name, color=colour, marker=marker, **plain) for name, (colour, marker) in LOOKS.items()]
    sizes = [
        entry(f"R/h = {cells}", color="0.3", marker="o", fillstyle=fill, **plain)
        for cells, fill in ((6, "none"), (10, "full"))
    ]
    legend_below(figure, [contacts, [*theory, *sizes]])
    return figure


def _theory(axes: Axes, poisson: float) -> list[Line2D]:
    slopes = np.linspace(0.15, 12.0, 64)  # over μ
    angles = psi(slopes, poisson)
    elastic = [psi(slope, poisson) * rebound(float(slope), poisson, 200, 1000) for slope in slopes]
    rigid = np.maximum(angles - sliding_from(poisson) - 1.0, 0.0)
    line = {"color": "0.2", "linewidth": 1.0}
    lines = axes.plot(angles, elastic, **line, label="closed form, elastic")
    return lines + axes.plot(angles, rigid, **line, linestyle="--", label="closed form, rigid")


def _mark(axes: Axes, run: CaseRun) -> None:
    colour, marker = LOOKS[str(run.method).removesuffix(", cpdi")]
    found, sphere = impact(run.results), SPHERES[run.place.make["test"]]
    before = psi(found["slope"] / sphere.friction, sphere.poisson)
    axes.plot(
        before, before * found["contact"], color=colour, marker=marker, markersize=5,
        fillstyle="full" if run.place.make["cells"] > 6 else "none",
    )  # fmt: skip
