"""Question: the Q term in C_n of [H17], eq. 7: what it changes in rolling and in the rings.

A shorter time step should change nothing: what it changes is the scatter of a run.
"""
# cost: 40

import differences
import rings
import rolling
from questions import FEW_POINTS

from mpmfw.validation import Runs, full, methods, together

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


@no_slip
def test_no_slip(run):
    errors(run, "no slip")


@slip
def test_slip(run):
    errors(run, "slip")


def errors(run, roll):
    """Record the errors of a roll."""
    for quantity, key, reference, unit in (
        ("displacement, error", "displacement", 0.0, "%"),
        ("spin, error", "spin", 0.0, "%"),
        ("mean penetration", "penetration", "", "h"),
    ):
        run.gate(f"{roll}: {quantity}", run.of(rolling.errors, key, roll=roll), reference, unit=unit)


@impact
def test_impact(run):
    error, depth = (run.of(rings.measures_of, key) for key in ("impulse_curve_error", "largest_penetration"))
    run.gate("rings: impulse curve, largest error", error, unit="%")
    run.gate("rings: largest penetration", depth, unit="h")


def change(case, runs, roll, label, beside=""):
    """Record how far one setting moves the end of a roll; gates are for the Q term with the usual springs."""
    value = runs.of(differences.at_end, label=label, beside=beside)
    quantity = f"{roll}: change of the displacement at 10 m"
    case.gate(quantity, value, "", LARGEST, "%", method=f"penalty, cpdi, {label}", binds=label == "with Q")


@together(no_slip)
def test_change_without_slip(case, runs):
    change(case, runs, "no slip", "with Q")
    change(case, runs, "no slip", "shorter step")
    if not case.quick:
        change(case, runs, "no slip", "kappa 0.1, with Q", "kappa 0.1")


@full
@together(slip)
def test_change_with_slip(case, runs):
    change(case, runs, "slip", "with Q")
    change(case, runs, "slip", "shorter step")


@full
@together(impact)
def test_change_of_impact(case, runs):
    for label in ("with Q", "shorter step"):
        value = runs.of(differences.largest, label=label)
        quantity = "rings: largest change of the impulse curve"
        case.gate(quantity, value, unit="%", method=f"penalty, cpdi, {label}")
