"""Free expansion at a contact corner: slope of the sides' displacement over the strain, for every method."""
# cost: 100

import expansion
from classical import MASTER, POSITION

from mpmfw.validation import SHAPES, Place, Runs, each, full, methods, together

SLOPES = tuple(expansion.PLACES)
STRONGER = {"stiffer body's normal": MASTER, "stiffer body's normal, position": {**MASTER, **POSITION}}
#: Loading is slow enough if half the speed gives the same slopes.
SLOWLY = {
    "time.end": 0.02,
    "time.output_interval": 0.0004,
    "bodies.bottom.sides": [{"side": "bottom", "velocity": [0.0, 0.005]}],
    "bodies.top.sides": [{"side": "top", "velocity": [0.0, -0.005]}],
}


def place(at, offset, size=0.0005):
    """Return the block ``offset`` cells past −5 mm, with the lower contact 0.13 cells past it."""
    side, below = -0.005 + offset * size, -0.005 + 0.13 * size
    above = below + 0.01
    corners = {
        "block": ([side, below], [side + 0.01, above]),
        "bottom": ([-0.008, below - 0.003], [0.008, below]),
        "top": ([-0.008, above], [0.008, above + 0.003]),
    }
    values = {"grid.cell_size": size}
    for body, (lower, upper) in corners.items():
        values |= {f"bodies.{body}.geometry.lower": lower, f"bodies.{body}.geometry.upper": upper}
    return Place(at, values)


every = Runs(
    "methods",
    methods=[
        *methods(["penalty", "bardenhagen"], SHAPES, when="full"),
        *methods(["bardenhagen"], ["cpdi", "gimp"], STRONGER, when="full"),
        *methods(["none"], SHAPES, when="full"),
        *methods(when="quick"),
    ],
    places=[place("", 0.23)],
)
half_speed = Runs("half speed", places=[Place("", {**place("", 0.23).set, **SLOWLY})], when="full")
#: Other places within a cell, gated at the scene's cell size, and other cell sizes, shown.
offsets = Runs(
    "offsets",
    places=[place(f", h = 0.5 mm, side at {offset:g} h", offset) for offset in (0, 0.5, 0.75)],
    when="full",
)
sizes = Runs(
    "sizes",
    places=[
        place(f", h = {1e3 * size:g} mm, side at {offset:g} h", offset, size)
        for size in (0.001, 0.0007)
        for offset in (0.23, 0, 0.5, 0.75)
    ],
    when="full",
)


@each(every, offsets)
def test_slopes(run):
    for key in SLOPES:
        run.gate(f"slope, {key}, error{run.place.at}", run.of(expansion.slopes, key), 0.0, 5.0, "%")
    if run.runs == "methods":
        run.gate("kinetic over strain energy, at most", run.of(expansion.slopes, "energy"), unit="%")


@half_speed
def test_half_speed(run):
    run.gate("kinetic over strain energy, at half the speed", run.of(expansion.slopes, "energy"), unit="%")


@sizes
def test_sizes(run):
    worst = run.of(expansion.slopes, "worst")
    run.gate(f"slope, worst error{run.place.at}", worst, 0.0, 5.0, "%", binds=False)


@full
@together(every, half_speed)
def test_change(case, runs):
    for key in SLOPES:
        fast, slow = (expansion.slope(run.results, key) for run in runs.only("penalty, cpdi"))
        quantity = f"slope, {key}, change at half the speed"
        case.gate(quantity, 100.0 * (slow / fast - 1.0), 0.0, unit="%", method="penalty, cpdi")
