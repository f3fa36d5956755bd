"""Question: friction increments, literal or added up to Coulomb's cone.

Literal friction increments of [H17] against the return map, at fractions of the stability limit. Without the
interface layer, beside which the inertia of rotation is not corrected.
"""
# cost: 100

import itertools
from math import inf

import increments
import rolling
from classical import LITERAL

from mpmfw.validation import Runs, each, full, methods, together

STABILITY = {**rolling.SERIES_ONLY, "output.stability": True}
NO_LAYER = {"contact.hamad2017.interface_thickness": 0.0}


def laws(*values, when=""):
    """Return both laws at each share of the limit of the time step."""
    settings = {
        f"{label}safety {value}": {**NO_LAYER, **law, "time.safety": value}
        for label, law in (("", {}), ("literal, ", LITERAL))
        for value in values
    }
    return methods(["hamad2017"], settings=settings, when=when)


no_slip = Runs(
    "no slip",
    "rolling-cylinder-no-slip",
    [*laws(0.1, 0.2, 0.4, 0.8, when="full"), *laws(0.4, 0.8, when="quick")],
    set=STABILITY,
    binds=["*, literal, *"],
)
slip = Runs(
    "slip",
    "rolling-cylinder-slip",
    laws(0.2, 0.4, 0.8),
    set=STABILITY,
    binds=["*, literal, *"],
    when="full",
)


@each(no_slip, slip)
def test_against_viscous(run):
    roll = run.runs
    for key in ("displacement", "acceleration", "spin"):
        run.gate(f"{roll}: {key}, error", run.of(rolling.errors, key, roll=roll), 0.0, unit="%")
    if run.method.matches("*, literal, *"):
        viscous, apart = (run.of(increments.viscous, key, roll=roll) for key in ("viscous", "apart"))
        run.gate(f"{roll}: displacement, error of viscous friction", viscous, unit="%")
        run.gate(f"{roll}: displacement, literal less viscous", apart, 0.0, 1.0, "%", binds=True)


@together(no_slip)
def test_steps_without_slip(case, runs):
    over_steps(case, runs, "no slip")


@full
@together(slip)
def test_steps_with_slip(case, runs):
    over_steps(case, runs, "slip")


def over_steps(case, runs, roll):
    """Record that the return map settles over the step, and that the literal law does not."""
    found = increments.by_step(runs, literal=False)
    quantity = f"{roll}: return map, displacement, range over time steps"
    case.gate(quantity, max(found) - min(found), "", (0.0, 0.1), "%")
    if not case.quick:
        literal = increments.by_step(runs, literal=True)
        growth = min(fine - coarse for fine, coarse in itertools.pairwise(literal))
        quantity = f"{roll}: literal, least growth of displacement as the step is halved"
        case.gate(quantity, growth, "", (1.0, inf), "%")
