"""Penalty spring: the stable step of two masses kept in contact, and the energy that a free impact gains."""

# cost: 40

import math
from typing import Any

import numpy as np
import spring

from mpmfw.runs.simulation import Simulation
from mpmfw.validation import SHAPES, Case, methods

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


def test_penalty_spring(case: Case) -> None:
    """Bisect the step, sweep the phase of an impact, and compare realistic pairs."""
    judge_limit(case)
    judge_impacts(case)
    if not case.quick:
        judge_pairs(case)


def judge_limit(case: Case) -> None:
    """Stable if and only if Δt < 2 / √(k / m_red)."""
    for method in methods(("penalty",), ("cpdi", "cpdi2") if case.quick else SHAPES):
        with case.timed():
            found = spring.bisect(
                lambda step, shape=method.shape: spring.stays(step, shape),
                0.5 * spring.LIMIT,
                1.5 * spring.LIMIT,
                0.01 if case.quick else 0.001,
            )
        error = 100.0 * (found / spring.LIMIT - 1.0)
        case.gate("largest stable step, error", error, 0.0, (-2.0, 2.0), "%", method)
    sim = Simulation(spring.scene(-1e-8))
    sim.start()
    sim.step(0.1 * spring.LIMIT)
    said = min(limit for limit, _ in sim.limits()) / spring.LIMIT
    case.show("limit that the strategy gives, over the exact", said, reference="≤ 1", method="penalty, cpdi")


def judge_impacts(case: Case) -> None:
    """Show the gain over the phase of the first touch beside the closed form, by steps per contact."""
    phases = np.linspace(0.002, 0.998, 7 if case.quick else 40)
    method = "penalty, cpdi"
    for steps, stated in STATED.items():
        with case.timed():
            gains, touching = np.array([spring.impact(steps, phase) for phase in phases]).T
        exact = np.array([spring.exact_gain(steps, phase) for phase in phases])
        worst = max(spring.exact_gain(steps, phase) for phase in np.linspace(0.002, 0.998, 100))
        at, off = f"{steps} steps per contact", np.abs(gains - exact).max()
        reference = round(100.0 * worst, 3)
        case.show(f"energy gain, worst phase, {at}", 100.0 * gains.max(), reference, unit="%", method=method)
        case.show(f"largest error of it over the phases, {at}", 100.0 * off, 0.0, unit="%", method=method)
        case.show(f"steps with a force, mean, {at}", touching.mean(), steps, method=method)
        if not math.isclose(worst, stated, rel_tol=0.05):
            raise ValueError(f"the closed form gives {worst} at {at} where {stated} is stated")


def judge_pairs(case: Case) -> None:
    """Compare what the strategy allows with what holds."""
    for label, values in PAIRS.items():
        with case.timed():
            reported, found = spring.realistic(values, 1500)
        method = f"penalty, cpdi, {label}"
        case.show("step that holds, over h / c", found, method=method)
        quantity, over = "limit that is refused beyond, over the step that holds", min(reported, 0.8) / found
        case.show(quantity, over, "≤ 1", (-math.inf, 1.0), method=method)
