"""Question: friction increments, literal or added up to Coulomb's cone.

Literal friction increments of [H17] against the return map, at fractions of the stability limit. Without the
interface layer, beside which the inertia of rotation is not corrected.
"""
# cost: 100

import itertools
import math
from math import inf

from common import LITERAL
from rolling import DISTANCE, GRAVITY, NO_SLIP, RADIUS, SERIES_ONLY, SLIP, errors

from mpmfw.validation import Runs, each, full, methods, together

TILTS = {"no slip": math.pi / 4.0, "slip": math.pi / 3.0}
MODULUS, CELL, SEGMENT = 10e6, 0.4, 0.1  #: M of the cylinder [Pa], h [m], length of a segment [m]
MASS = 1000.0 * math.pi * RADIUS**2  #: of the cylinder [kg/m]


def viscous(roll, time_step, width):
    """Return the error of the displacement under a viscous friction of the same size [%].

    f_t = −k_t Δg_t of one step is −k_t Δt v, a dashpot with c = k_t Δt; over a contact of ``width`` the slave
    nodes' k_t = κ M l_trib / h add up to κ M w / h."""
    pull = GRAVITY * math.sin(TILTS[roll])
    drag = MODULUS * width * SEGMENT * time_step / CELL  # κ = 1 [N s/m per metre of thickness]
    time = (SLIP if roll == "slip" else NO_SLIP).end
    decay = MASS / (3.0 * drag)
    slipped = pull * decay * (time - decay * -math.expm1(-time / decay))
    return 100.0 * ((pull * time**2 / 3.0 + slipped / 3.0) / DISTANCE - 1.0)


def apart(run, roll):
    """Return how far the displacement is from that under viscous friction [%]."""
    series = run["series"].to_dataset()
    width, time_step = (float(series[name][1:].mean()) for name in ("contact_count", "time_step"))
    return errors(run, roll)["displacement"] - viscous(roll, time_step, width)


def by_step(runs, literal):
    """Return errors of the displacement of one law [%], from the smallest time step to the largest."""
    own = [run for run in runs if run.method.label.startswith("literal") == literal]
    own.sort(key=lambda run: run.method.set["time.safety"])
    return [run.of(errors, "displacement", roll=run.runs) for run in own]


STABILITY = {**SERIES_ONLY, "output.stability": True}
NO_LAYER = {"contact.hamad2017.interface_thickness": 0.0}


def laws(*values, when=""):
    """Return both laws at each share of the limit of the time step."""
    settings = {
        f"{label}safety {value}": {**NO_LAYER, **law, "time.safety": value}
        for label, law in (("", {}), ("literal, ", LITERAL))
        for value in values
    }
    return methods(["hamad2017"], settings=settings, when=when)


BOUND = ["*, literal, *"]
no_slip = Runs(
    "no slip",
    "rolling-cylinder-no-slip",
    [*laws(0.1, 0.2, 0.4, 0.8, when="full"), *laws(0.4, 0.8, when="quick")],
    set=STABILITY,
    binds=BOUND,
)
slip = Runs("slip", "rolling-cylinder-slip", laws(0.2, 0.4, 0.8), set=STABILITY, binds=BOUND, when="full")


@each(no_slip, slip)
def test_against_viscous(run):
    if run.method.matches(*BOUND):
        value = run.of(apart, roll=run.runs)
        run.gate(f"{run.runs}: displacement, literal less viscous", value, 0.0, 1.0, "%", binds=True)


@together(no_slip)
def test_steps_without_slip(case, runs):
    over_steps(case, runs, "no slip")


@full
@together(slip)
def test_steps_with_slip(case, runs):
    over_steps(case, runs, "slip")


def over_steps(case, runs, roll):
    """Record that the return map settles over the step, and that the literal law does not."""
    found = by_step(runs, literal=False)
    quantity = f"{roll}: return map, displacement, range over time steps"
    case.gate(quantity, max(found) - min(found), "", (0.0, 0.1), "%")
    if not case.quick:
        literal = by_step(runs, literal=True)
        growth = min(fine - coarse for fine, coarse in itertools.pairwise(literal))
        quantity = f"{roll}: literal, least growth of displacement as the step is halved"
        case.gate(quantity, growth, "", (1.0, inf), "%")
