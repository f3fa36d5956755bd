"""Penalty spring: the stable step of two masses kept in contact, and the energy that a free impact gains."""

# cost: 40

from __future__ import annotations

import math
from typing import Any

import numpy as np
import spring
from matplotlib.figure import Figure

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.runs.simulation import Simulation
from mpmfw.state.fields import FloatArray
from mpmfw.validation import SHAPES, Case

#: Energy gained in the worst phase by the two numbers of :func:`spring.exact_gain`, by steps per contact.
STATED = {3: 0.18, 5: 0.033, 10: 0.004}
#: Pairs of :func:`spring.realistic`: stiffness of the springs, and of the right block over the left one's.
PAIRS: dict[str, dict[str, Any]] = {
    "κ = 1, equal": {"contact.penalty.kappa": 1.0},
    "κ = 10, equal": {"contact.penalty.kappa": 10.0},
    "κ = 1, stiffness 1 : 100": {
        "contact.penalty.kappa": 1.0,
        "materials.right.bulk_modulus": 61.9,
        "materials.right.shear_modulus": 28.6,
    },
    "κ = 1, density 1 : 100": {"contact.penalty.kappa": 1.0, "materials.right.density": 100.0},
}


def check(case: Case) -> None:
    """Bisect the step, sweep the phase of an impact, and compare what the strategy says of realistic pairs."""
    judge_limit(case)
    gains = judge_impacts(case)
    if not case.quick:
        judge_pairs(case)
        case.figure("", figure(gains))


def judge_limit(case: Case) -> None:
    """Stable if and only if Δt < 2 / √(k / m_red)."""
    for method in case.methods(("penalty",), ("cpdi", "cpdi2") if case.quick else SHAPES):
        with case.timed():
            found = spring.bisect(
                lambda step, shape=method.shape: spring.stays(step, shape),
                0.5 * spring.LIMIT,
                1.5 * spring.LIMIT,
                0.01 if case.quick else 0.001,
            )
        error = 100.0 * (found / spring.LIMIT - 1.0)
        case.judge(method, "largest stable step, error", error, within=(-2.0, 2.0), unit="%", reference=0.0)
    sim = Simulation(spring.scene(-1e-8))
    sim.start()
    sim.step(0.1 * spring.LIMIT)
    said = min(limit for limit, _ in sim.limits()) / spring.LIMIT
    case.show("limit that the strategy gives, over the exact", said, reference="≤ 1", method="penalty, cpdi")


def judge_impacts(case: Case) -> dict[int, FloatArray]:
    """Gain by phase of the first touch (phase, exact, measured) for each number of steps."""
    phases = np.linspace(0.002, 0.998, 7 if case.quick else 40)
    gains = {}
    for steps, stated in STATED.items():
        with case.timed():
            events = [spring.impact(steps, phase) for phase in phases]
        measured = np.array([event.gain for event in events])
        exact = np.array([spring.exact_gain(steps, phase) for phase in phases])
        gains[steps] = np.array([phases, exact, measured])
        at = f"{steps} steps per contact"
        case.show(
            f"energy gain, worst phase, {at}",
            100.0 * measured.max(),
            unit="%",
            reference=round(100.0 * worst(steps), 3),
            method="penalty, cpdi",
        )
        case.show(
            f"largest error of it over the phases, {at}",
            100.0 * float(np.abs(measured - exact).max()),
            unit="%",
            reference=0.0,
            method="penalty, cpdi",
        )
        touching = np.mean([event.touching for event in events])
        case.show(f"steps with a force, mean, {at}", float(touching), reference=steps, method="penalty, cpdi")
        if not math.isclose(worst(steps), stated, rel_tol=0.05):
            raise ValueError(f"the closed form gives {worst(steps)} at {at} where {stated} is stated")
    return gains


def worst(steps: float) -> float:
    """The closed form's largest gain."""
    return max(spring.exact_gain(steps, phase) for phase in np.linspace(0.002, 0.998, 100))


def judge_pairs(case: Case) -> None:
    """What the strategy allows against what holds."""
    for label, values in PAIRS.items():
        with case.timed():
            pair = spring.realistic(values, 1500)
        method = f"penalty, cpdi, {label}"
        case.show("step that holds, over h / c", pair.found / pair.bulk, method=method)
        said = min(pair.reported, 0.8 * pair.bulk)
        case.show(
            "limit that is refused beyond, over the step that holds",
            said / pair.found,
            within=(-math.inf, 1.0),
            reference="≤ 1",
            method=method,
        )


def figure(gains: dict[int, FloatArray]) -> Figure:
    """Energy gain over the phase, and its worst over the steps per contact."""
    result = new_figure(1, 2, 50.0)
    above, below = result.subplots(2, 1)
    for (steps, (phase, _, measured)), colour in zip(
        gains.items(), ("#D55E00", "#009E73", "#0072B2"), strict=True
    ):
        fine = np.linspace(0.001, 0.999, 300)
        exact = [100.0 * spring.exact_gain(steps, x) for x in fine]
        above.plot(fine, exact, "-", color=colour, linewidth=0.8)
        above.plot(
            phase, 100.0 * measured, "o", color=colour, markersize=2.5, label=f"{steps} steps per contact"
        )
        below.plot(steps, 100.0 * measured.max(), "o", color=colour, markersize=4.0)
    count = np.concatenate([np.linspace(2.2, 15.0, 385), np.arange(15.05, 30.0, 0.05)])
    line = below.loglog(count, [100.0 * worst(n) for n in count], "k-", linewidth=0.8, label="closed form")
    dress(above, "first touch after this part of a step [1]", "energy gain [%]")
    dress(below, "steps per contact [1]", "energy gain, worst phase [%]")
    below.set_xticks([2, 3, 5, 10, 20, 30], ["2", "3", "5", "10", "20", "30"])
    below.minorticks_off()
    legend_below(
        result, [above.get_legend_handles_labels()[0][:2], [above.get_legend_handles_labels()[0][2], *line]]
    )
    return result
