"""Question: friction increments, literal or added up to Coulomb's cone.

Literal friction increments of [H17] against the return map, over the time step, at fractions of the stability
limit, and over μ. Without the interface layer, beside which the inertia of rotation is not corrected.
"""
# cost: 140

import itertools
from math import inf

import increments
import rolling
from classical import LITERAL

from mpmfw.validation import Runs, each, full, methods, together

STABILITY = {**rolling.SERIES_ONLY, "output.stability": True}


def laws(name, values, when=""):
    """Return both laws at each value, labelled by its name."""
    settings = {}
    for label, law in (("", {}), ("literal, ", LITERAL)):
        for value in values:
            chosen = {"time.safety": value}
            if name == "mu":
                chosen = {"contact.pairs": [{"bodies": ["cylinder", "plane"], "friction": value}]}
            no_layer = {"contact.hamad2017.interface_thickness": 0.0}
            settings[f"{label}{name} {value}"] = {**no_layer, **law, **chosen}
    return methods(["hamad2017"], settings=settings, when=when)


no_slip = Runs(
    "no slip",
    "rolling-cylinder-no-slip",
    [*laws("safety", (0.1, 0.2, 0.4, 0.8), "full"), *laws("safety", (0.4, 0.8), "quick")],
    set=STABILITY,
    binds=["*, literal, *"],
)
slip = Runs(
    "slip",
    "rolling-cylinder-slip",
    laws("safety", (0.2, 0.4, 0.8)),
    set=STABILITY,
    binds=["*, literal, *"],
    when="full",
)
#: tan θ / 3 = 0.577 divides slip from none at 60°; the least friction is as good as none.
frictions = Runs(
    "frictions",
    "rolling-cylinder-slip",
    laws("mu", (0.001, 0.1, 0.286, 0.45, 0.8)),
    set={**rolling.SERIES_ONLY, "time.safety": 0.8},
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


@frictions
def test_frictions(run):
    fitted, rigid = (run.of(increments.on_slope, key) for key in ("fitted", "rigid"))
    run.gate("60°: fitted acceleration", fitted, rigid, unit="m/s²")


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
