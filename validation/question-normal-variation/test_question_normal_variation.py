"""Question: the Q term in C_n of [H17], eq. 7: what it changes in rolling and in the rings.

A shorter time step should change nothing: what it changes is the scatter of a run.
"""
# cost: 40

import numpy as np
import rings
import rolling
from questions import FEW_POINTS

from mpmfw.results.analysis import impulse
from mpmfw.validation import Runs, each, full, methods, together

WITH_Q = {"contact.penalty.normal_variation": "hamad2017"}
SETTINGS = {"": {}, "with Q": WITH_Q, "shorter step": {"time.safety": 0.35}}
SOFT = {"contact.penalty.kappa": 0.1}
#: Largest effect on a displacement at the end of the roll [%], from the list of benchmarks' notes.
LARGEST = 0.06

no_slip = Runs(
    "no slip",
    "rolling-cylinder-no-slip",
    [
        *methods(settings=SETTINGS),
        *methods(settings={"kappa 0.1": SOFT, "kappa 0.1, with Q": {**SOFT, **WITH_Q}}, when="full"),
    ],
    set=rolling.SERIES_ONLY,
    quick={"grid.cell_size": 0.8},
)
slip = Runs("slip", "rolling-cylinder-slip", methods(settings=SETTINGS), set=rolling.SERIES_ONLY, when="full")
impact = Runs("rings", "colliding-rings", methods(settings=SETTINGS), set=FEW_POINTS, when="full")


@each(no_slip, slip)
def test_roll(run):
    run.gates(
        rolling.errors,
        (f"{run.runs}: displacement, error", "displacement", 0.0, None, "%"),
        (f"{run.runs}: spin, error", "spin", 0.0, None, "%"),
        (f"{run.runs}: mean penetration", "penetration", "", None, "h"),
        roll=run.runs,
    )


@impact
def test_impact(run):
    run.gates(
        rings.measures_of,
        ("rings: impulse curve, largest error", "impulse_curve_error", "", None, "%"),
        ("rings: largest penetration", "largest_penetration", "", None, "h"),
    )


def change(case, runs, label, beside=""):
    """Record how far one setting moves the end of a roll; gates are for the Q term with the usual springs."""
    motions = {run.method.label: rolling.motion_of(run.results) for run in runs}
    if label not in motions or beside not in motions:
        return
    roll, motion = runs[0].runs, motions[label]
    end = (rolling.SLIP if roll == "slip" else rolling.NO_SLIP).end
    apart = 100.0 * (motion.displacement - motions[beside].displacement) / rolling.DISTANCE
    quantity, method = f"{roll}: change of the displacement at 10 m", f"penalty, cpdi, {label}"
    value = np.interp(end, motion.time, apart)
    case.gate(quantity, value, "", LARGEST, "%", method=method, binds=label == "with Q")


@together(no_slip)
def test_change_without_slip(case, runs):
    change(case, runs, "with Q")
    change(case, runs, "shorter step")
    if not case.quick:
        change(case, runs, "kappa 0.1, with Q", "kappa 0.1")


@full
@together(slip)
def test_change_with_slip(case, runs):
    change(case, runs, "with Q")
    change(case, runs, "shorter step")


@full
@together(impact)
def test_change_of_impact(case, runs):
    impulses = {run.method.label: impulse(*rings.force_of(rings.series_of(run.results))) for run in runs}
    for label in ("with Q", "shorter step"):
        if label in impulses and "" in impulses:
            apart = np.abs(100.0 * (impulses[label] - impulses[""]) / impulses[""][-1])
            quantity, method = "rings: largest change of the impulse curve", f"penalty, cpdi, {label}"
            case.gate(quantity, apart.max(), unit="%", method=method)
