"""Question: the Q term in C_n of [H17], eq. 7: what it changes in rolling.

A shorter time step should change nothing: what it changes is the scatter of a run.
"""
# cost: 25

import numpy as np
import rolling

from mpmfw.validation import Runs, full, methods, together

WITH_Q = {"contact.penalty.normal_variation": "hamad2017"}
SETTINGS = {"": {}, "with Q": WITH_Q, "shorter step": {"time.safety": 0.35}}
#: Largest effect on a displacement at the end of the roll [%], from the list of benchmarks' notes.
LARGEST = 0.06

no_slip = Runs(
    "no slip",
    "rolling-cylinder-no-slip",
    methods(settings=SETTINGS),
    set=rolling.SERIES_ONLY,
    quick={"grid.cell_size": 0.8},
)
slip = Runs("slip", "rolling-cylinder-slip", methods(settings=SETTINGS), set=rolling.SERIES_ONLY, when="full")


def change(case, runs):
    """Record how far each setting moves the end of a roll; gates are for the Q term."""
    motions = {run.method.label: rolling.motion_of(run.results) for run in runs}
    roll, usual = runs[0].runs, motions.pop("")
    end = (rolling.SLIP if roll == "slip" else rolling.NO_SLIP).end
    for label, motion in motions.items():
        apart = 100.0 * (motion.displacement - usual.displacement) / rolling.DISTANCE
        value, named = np.interp(end, motion.time, apart), f"penalty, cpdi, {label}"
        quantity = f"{roll}: change of the displacement at 10 m"
        case.gate(quantity, value, "", LARGEST, "%", method=named, binds=label == "with Q")


@together(no_slip)
def test_change_without_slip(case, runs):
    change(case, runs)


@full
@together(slip)
def test_change_with_slip(case, runs):
    change(case, runs)
