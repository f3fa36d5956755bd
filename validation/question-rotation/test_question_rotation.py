"""Question: what the rotational inertia of the grid costs.

Rotational inertia by local spin, exact and lumped: rolling over offsets of the grid's origin and over cell
sizes. What lumping costs beside ε/3 is in rolling-convergence."""
# cost: 180

import itertools

import numpy as np
import rolling
from common import over

from mpmfw.validation import Place, Runs, full, methods, together

TREATMENTS = {"": {}, **over("bodies.cylinder.rotation", "{}", ("exact", "lumped"))}
OFFSETS = {"(0, 0)": [-1.6, -1.6], "(0.37, 0.21)": [-1.748, -1.6840000000000002]}


def cells(roll, size, offsets=("(0, 0)",), treatments=tuple(TREATMENTS), when="full"):
    """Return the runs of one roll with one cell size."""
    places = [
        Place(f"{roll}, h = {size} m, offset {at} h", {"grid.cell_size": size, "grid.lower": OFFSETS[at]})
        for at in offsets
    ]
    return Runs(
        f"{roll}, h = {size} m",
        f"rolling-cylinder-{roll.replace(' ', '-')}",
        methods(settings={name: TREATMENTS[name] for name in treatments}),
        places,
        set=rolling.SERIES_ONLY,
        when=when,
    )


no_slip_8 = cells("no slip", 0.8, treatments=("", "exact"), when="")
no_slip_4, slip_4 = cells("no slip", 0.4, OFFSETS), cells("slip", 0.4, OFFSETS, ("", "exact"))
no_slip_2, slip_2 = (cells(roll, 0.2, treatments=("", "exact")) for roll in ("no slip", "slip"))


def roll_of(run):
    """Return ``slip`` or ``no slip``."""
    return run.runs.partition(",")[0]


def errors(runs, rotation, key):
    """Return the errors of a treatment at all offsets [%]; NaN if none of its runs ended."""
    own = [run for run in runs if (run.method.label or "spin") == rotation]
    return np.array([run.of(rolling.errors, key, roll=roll_of(run)) for run in own] or [np.nan])


def compare(case, runs, at):
    """Record that the local spin correction, which is causal, rolls as the exact one, which is not."""
    for key, most in (("acceleration", 0.3), ("angular acceleration", 0.5)):
        apart = np.subtract(errors(runs, "spin", key), errors(runs, "exact", key))
        largest = apart[np.argmax(np.abs(apart))]
        case.gate(f"{at}: fitted {key}, spin less exact", largest, 0.0, most, "%")


@together(no_slip_8)
def test_coarse(case, runs):
    compare(case, runs, no_slip_8.name)


@full
@together(no_slip_4, slip_4, no_slip_2, slip_2)
def test_fine(case, runs):
    for at in dict.fromkeys(run.runs for run in runs):
        compare(case, [run for run in runs if run.runs == at], at)


@full
@together(no_slip_4)
def test_gain(case, runs):
    quantities = (("displacement at 10 m", "displacement"), ("fitted acceleration", "acceleration"))
    for rotation, (quantity, key) in itertools.product(("spin", "exact"), quantities):
        own, lumped = (np.max(np.abs(errors(runs, how, key))) for how in (rotation, "lumped"))
        quantity = f"{no_slip_4.name}: {quantity}, error of {rotation} over that of lumped"
        case.gate(quantity, own / lumped, "below 1", (0.0, 0.5))
