"""A rigid strip footing, rough and smooth, on clay without drainage: the limit load of Prandtl."""
# cost: 230

import numpy as np
from common import held_load

from mpmfw.validation import CLASSICAL, Place, Runs, each, methods, together

#: (2 + π) c_u B of the shipped scene [N/m]: c_u = 10 kPa, B = 1 m.
PRANDTL = (2.0 + np.pi) * 1e4
SMOOTH = {"contact.friction": 0.0}


def places(*parts):
    """Return a place for cells of B over each number of ``parts``; gates bind within its tolerance [%]."""
    return [
        Place(f"B/h = {n}", set={"grid.cell_size": 1.0 / n}, within={"load": (-least, tolerance)}, when=when)
        for n, least, tolerance, when in parts
    ]


coarse = Runs(
    "footing",
    "footing",
    [
        *methods(settings={"rough": {}}, bound=True),
        *methods(settings={"smooth": SMOOTH}, bound=True, when="full"),
        *methods([CLASSICAL[1]], settings={"rough": {}, "smooth": SMOOTH}, bound=True, when="full"),
    ],
    places((8, 0.0, 12.0, ""), (16, 0.0, 6.0, "full")),
    set={"output.particles": False},
)
fine = Runs(
    "fine",
    "footing",
    methods(settings={"rough": {}}, bound=True),
    places((32, 3.0, 3.0, "full")),
    set={"output.particles": False},
)
laws = Runs(
    "laws",
    "footing",
    methods(["lcp"]) + methods(shape=["cpdi2", "gimp", "bspline"]),
    places((8, 0.0, 12.0, "full")),
    set={"output.particles": False},
)

held = Runs(
    "held",
    "footing",
    [*methods([""], settings={"rough": {}}), *methods([""], settings={"smooth": SMOOTH}, when="full")],
    [Place("B/h = 8"), Place("B/h = 16", set={"grid.cell_size": 1.0 / 16.0}, when="full")],
    by=held_load,
)


def load(tree):
    """Return the error [%] of the mean reaction over the last third, and how far it varies there [%]."""
    force = tree["series"]["reaction"].sel(body="footing", axis="y").values
    late = force[2 * len(force) // 3 :]
    return {
        "load": 100.0 * (late.mean() / PRANDTL - 1.0),
        "varies": 100.0 * float(np.std(late) / late.mean()),
    }


@each(coarse, fine, laws)
def test_footing(run):
    binds = run.method.contact == "penalty" and run.runs != laws.name
    at, value, varies = run.place.at, run.of(load, "load"), run.of(load, "varies")
    run.gate(f"limit load, error, {at}", value, 0.0, None, "%", key="load", binds=binds)
    run.gate(f"standard deviation over the last third, {at}", varies, 0.0, 2.0, "%", binds=binds)


@each(held)
def test_held(run):
    value = 100.0 * (run.results / PRANDTL - 1.0)
    run.gate(f"limit load with nodes held instead of contact, error, {run.place.at}", value, 0.0, None, "%")


@together(coarse, held)
def test_against_held(case, runs):
    """Contact at edges on lines of the grid adds little to the load of the nodes that it holds."""
    found = {(run.method.contact, run.method.label, run.place.at): run for run in runs}
    for (contact, label, at), run in found.items():
        if contact:
            less = run.of(load, "load") - 100.0 * (found["", label, at].results / PRANDTL - 1.0)
            binds = contact == "penalty"
            case.gate(f"that load less the one of held nodes, {at}", less, 0.0, 2.0, "%", run.method, binds)
