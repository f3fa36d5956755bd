"""Contact stress under a block: σ_yy = −p at the interface, also with wrong surface-to-grid maps."""
# cost: 50

from dataclasses import replace
from math import inf

import blocks
import figures
from classical import POSITION, specified
from convergence import observed_order

from mpmfw.validation import RECOMMENDED, SHAPES, Place, Runs, each, full, methods, together

GIVEN = specified(0.0, 1.0)
WRONG = {"wrong map": {"contact.penalty.map": "mass_weighted"}}
UNLIKE = {"bodies.upper.particles.size": "0.45 cells", "bodies.upper.segment": "0.22 cells"}
#: Methods that run at every offset: the recommended ones, and classical contact in both forms.
EVERYWHERE = [
    *methods(shape=RECOMMENDED),
    *methods(["bardenhagen"], settings={"": {}, "normal given": GIVEN}),
]


def place(at, size, lower, upper):
    """Return cells of a size with the interface at a height, and the top of the upper block."""
    values = {
        "grid.cell_size": size,
        "bodies.lower.geometry.upper": [1.0, lower],
        "bodies.upper.geometry.lower": [0.0, lower],
        "bodies.upper.geometry.upper": [1.0, upper],
    }
    return Place(at, values)


every = Runs(
    "methods",
    methods=[
        *methods(shape=SHAPES, when="full"),
        *methods(shape=RECOMMENDED, settings={"unlike points and segments": UNLIKE}, when="full"),
        *methods(
            shape=["linear", "gimp"], settings={"plain map": {"contact.penalty.map": "plain"}}, when="full"
        ),
        *methods(shape=["bspline"], settings=WRONG, when="full"),
        *methods(
            ["bardenhagen"],
            SHAPES,
            settings={
                "": {},
                "normal given": GIVEN,
                "normal given, position": {**GIVEN, **POSITION},
            },
            when="full",
        ),
        *methods(["none"], SHAPES, when="full"),
        *methods(when="quick"),
    ],
    places=[place("at 0.37 h", 0.1, 1.037, 2.037)],
)
higher = Runs("higher", methods=EVERYWHERE, places=[place("at 0.81 h", 0.1, 1.081, 2.081)], when="full")
#: The case has to tell a wrong map: it must miss the limit that the right one keeps.
wrong = Runs(
    "wrong",
    methods=[
        *methods(shape=RECOMMENDED, settings=WRONG, when="full"),
        *methods(settings=WRONG, when="quick"),
    ],
    places=[*every.places, replace(higher.places[0], when="full")],
    binds=["*"],
)
#: The interface is kept at the same place within a cell.
cells = Runs(
    "convergence",
    methods=EVERYWHERE,
    places=[
        place("h = 0.2 m", 0.2, 1.074, 2.074),
        place("h = 0.1 m", 0.1, 1.037, 2.037),
        place("h = 0.05 m", 0.05, 1.0185, 2.0185),
    ],
    when="full",
)


@each(every, higher)
def test_right_map(run):
    run.gates(
        blocks.stress,
        ("mean σ_yy, error, {at}", "mean", 0.0, 3.0, "%"),
        ("largest departure, {at}", "departure", 0.0, (0.0, 3.0), "%"),
    )
    off = run.of(blocks.stress, "off the walls")
    run.gate(f"largest departure off the walls, {run.place.at}", off, 0.0, (0.0, 3.0), "%", binds=False)


@wrong
def test_wrong_map(run):
    off = run.of(blocks.stress, "off the walls")
    run.gate(f"departure off the walls, must be seen, {run.place.at}", off, "", (3.0, inf), "%", binds=True)


@cells
def test_convergence(run):
    run.gate(f"L2 error of σ_yy, {run.place.at}", run.of(blocks.stress, "l2"), 0.0, unit="%")


@full
@together(cells)
def test_orders(case, runs):
    for method, same in runs.by_method():
        sizes = [run.results.attrs["cell_size"] for run in same]
        for quantity, key in (("L2 error of σ_yy", "l2"), ("departure off the walls", "off the walls")):
            order = observed_order(sizes, [run.of(blocks.stress, key) for run in same])
            case.gate(f"observed order, {quantity}", order, method=method)
    case.figure("convergence", figures.convergence(runs))
