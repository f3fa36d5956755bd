"""The figures of the case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from rolling import EXACT, NO_SLIP, SLIP, Motion, Roll, line, motion_of

from mpmfw.plots.style import Look, dress, legend_below, new_figure
from mpmfw.validation import CLASSICAL, SHAPES, CaseRun, Method

Motions = Mapping[Roll, Mapping[Method, Motion]]

#: Colour and line style by contact and label, all with CPDI.
_LOOKS: dict[tuple[str, str], tuple[str, Any]] = {
    ("none", ""): ("#009E73", ":"),
    ("bardenhagen", ""): ("#D55E00", "-"),
    ("bardenhagen", "criterion = position"): ("#E69F00", "--"),
    ("bardenhagen", "normal = master"): ("#7F3C8D", "-."),
    (CLASSICAL[1], ""): ("#117733", "-"),
    ("penalty", ""): ("#0072B2", "-"),
    ("penalty", "rotation = lumped"): ("#56B4E9", "--"),
    ("hamad2017", ""): ("0.2", (0, (1, 1))),
    ("hamad2017", "literal"): ("0.45", (0, (3, 1, 1, 1))),
}
_PUBLISHED = [("none", ""), *((contact, "") for contact in CLASSICAL), ("penalty", "")]
#: Slip, then no slip: by how much displacements may depart in the figure [m]; what sticks lies outside.
_DEPARTURES = ((-1.0, 0.3), (-2.2, 2.2))


def _motions(runs: Sequence[CaseRun]) -> Motions:
    return {
        roll: {run.method: motion_of(run.results) for run in runs if run.runs == roll.name}
        for roll in (SLIP, NO_SLIP)
    }


def as_published(every: Sequence[CaseRun]) -> Figure:
    """[H17] fig. 1: displacement and velocity, slip above and no slip below."""
    motions = _motions(every)
    figure = new_figure(2, 2)
    panels = figure.subplots(2, 2, sharex="row")
    for (left, right), (roll, runs) in zip(panels, motions.items(), strict=True):
        for look, motion in _with_cpdi(runs).items():
            if look in _PUBLISHED:
                left.plot(motion.time, motion.displacement, **line(_LOOKS[look]))
                right.plot(motion.time, motion.velocity, **line(_LOOKS[look]))
        time = _longest(runs)
        left.plot(time, roll.solution.displacement(time), **_DASHED)
        right.plot(time, roll.solution.velocity(time), **_DASHED)
        dress(left, "time [s]", "displacement [m]", f"{roll.name}: displacement")
        dress(right, "time [s]", "velocity [m/s]", f"{roll.name}: velocity")
        for axes in (left, right):
            axes.set_xlim(0.0, time[-1])
            axes.set_ylim(bottom=-0.09 * axes.get_ylim()[1])  # what sticks swings back and forth
    legend_below(figure, [_key(_drawn(motions, _PUBLISHED))])
    return figure


def spin_and_departure(every: Sequence[CaseRun]) -> Figure:
    """Draw angular velocity, and displacement less the closed form."""
    motions = _motions(every)
    figure = new_figure(2, 2)
    panels = figure.subplots(2, 2, sharex="row")
    for (left, right), (roll, runs), room in zip(panels, motions.items(), _DEPARTURES, strict=True):
        for look, motion in _with_cpdi(runs).items():
            left.plot(motion.time, motion.spin, **line(_LOOKS[look]))
            away = motion.displacement - roll.solution.displacement(motion.time)
            right.plot(motion.time, away, **line(_LOOKS[look]))
        time = _longest(runs)
        left.plot(time, -roll.solution.spin(time), **_DASHED)
        right.axhline(0.0, **_DASHED)
        right.set_ylim(room)
        dress(left, "time [s]", "clockwise spin [rad/s]", f"{roll.name}: spin")
        dress(right, "time [s]", "displacement − closed form [m]", f"{roll.name}: departure")
        for axes in (left, right):
            axes.set_xlim(0.0, time[-1])
    keys = _key(_drawn(motions, list(_LOOKS)))
    legend_below(figure, [keys[:4], keys[4:]])
    return figure


def all_shapes(every: Sequence[CaseRun]) -> Figure:
    """Draw displacement less the closed form with every shape function, by contact."""
    contacts = ["penalty", *CLASSICAL]
    look = Look(xr.Dataset(coords={"contact": contacts, "shape": list(SHAPES)}))
    motions = _motions(every)
    figure = new_figure(3, 2)
    panels = figure.subplots(2, 3, sharex="row")
    for row, (roll, runs) in zip(panels, motions.items(), strict=True):
        for axes, contact in zip(row, contacts, strict=True):
            axes.axhline(0.0, **EXACT)
            chosen = [m for m in runs if m.contact == contact and not m.label]
            for turn, method in enumerate(chosen):
                motion = runs[method]
                away = motion.displacement - roll.solution.displacement(motion.time)
                axes.plot(motion.time, away, **look.line(contact, method.shape, len(motion.time), turn))
            dress(axes, "time [s]", "displacement − closed form [m]", f"{roll.name}: {contact}")
            axes.set_xlim(0.0, _longest(runs)[-1])
    exact = Line2D([], [], color="black", linewidth=0.8, label="closed form")
    colours, styles = look.key()
    legend_below(figure, [[exact, *colours], styles])
    return figure


_DASHED: dict[str, Any] = {**EXACT, "linestyle": (0, (4, 3))}


def _with_cpdi(runs: Mapping[Method, Motion]) -> dict[tuple[str, str], Motion]:
    chosen = {(m.contact, m.label): motion for m, motion in runs.items() if m.shape == "cpdi"}
    return {look: chosen[look] for look in _LOOKS if look in chosen}


def _drawn(motions: Motions, among: list[tuple[str, str]]) -> list[tuple[str, str]]:
    there = {look for runs in motions.values() for look in _with_cpdi(runs)}
    return [look for look in among if look in there]


def _longest(runs: Mapping[Method, Motion]) -> Any:
    return max((motion.time for motion in runs.values()), key=lambda time: time[-1])


def _key(looks: list[tuple[str, str]]) -> list[Line2D]:
    names = {look: ", ".join(filter(None, look)) for look in looks}
    exact = Line2D([], [], **_DASHED, label="closed form")
    return [exact, *(Line2D([], [], **line(_LOOKS[look]), label=names[look]) for look in looks)]
