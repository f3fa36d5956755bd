"""A rigid strip footing, rough and smooth, on clay without drainage: the limit load of Prandtl."""
# cost: 230

import numpy as np

from mpmfw.validation import CLASSICAL, Place, Runs, each, methods

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
