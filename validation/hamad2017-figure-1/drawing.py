"""The figure of the case."""

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from rolling import EXACT, NO_SLIP, SLIP, motion_of

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CLASSICAL, CaseRun

#: Looks by contact, all with CPDI and no other change.
LOOKS: dict[str, dict[str, Any]] = {
    "none": {"color": "#009E73", "linestyle": ":", "linewidth": 1.2},
    CLASSICAL[0]: {"color": "#D55E00", "linestyle": "-", "linewidth": 1.2},
    CLASSICAL[1]: {"color": "#117733", "linestyle": "-", "linewidth": 1.2},
    "penalty": {"color": "#0072B2", "linestyle": "-", "linewidth": 1.2},
}
DASHED = {**EXACT, "linestyle": (0, (4, 3))}


def as_published(runs: Sequence[CaseRun]) -> Figure:
    """[H17] fig. 1: displacement and velocity, slip above and no slip below."""
    figure = new_figure(2, 2)
    panels = figure.subplots(2, 2, sharex="row")
    shown = [run for run in runs if run.method.shape == "cpdi" and not run.method.label]
    for (left, right), roll in zip(panels, (SLIP, NO_SLIP), strict=True):
        motions = {run.method.contact: motion_of(run.results) for run in shown if run.runs == roll.name}
        for contact in LOOKS:
            if contact in motions:
                motion = motions[contact]
                left.plot(motion.time, motion.displacement, **LOOKS[contact])
                right.plot(motion.time, motion.velocity, **LOOKS[contact])
        time = max((motion.time for motion in motions.values()), key=lambda time: time[-1])
        left.plot(time, roll.solution.displacement(time), **DASHED)
        right.plot(time, roll.solution.velocity(time), **DASHED)
        dress(left, "time [s]", "displacement [m]", f"{roll.name}: displacement")
        dress(right, "time [s]", "velocity [m/s]", f"{roll.name}: velocity")
        for axes in (left, right):
            axes.set_xlim(0.0, time[-1])
            axes.set_ylim(bottom=-0.09 * axes.get_ylim()[1])  # what sticks swings back and forth
    drawn = {run.method.contact for run in shown}
    keys = [Line2D([], [], **LOOKS[contact], label=contact) for contact in LOOKS if contact in drawn]
    legend_below(figure, [[Line2D([], [], **DASHED, label="closed form"), *keys]])
    return figure
