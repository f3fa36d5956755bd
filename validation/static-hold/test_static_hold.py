"""Static hold: a block that friction must hold, with every contact and every shape function.

Linear functions take MUSL by themselves, see the README. The drift's limit is a tenth of the
displacement's, which a block creeping at this rate would reach in ten seconds. What is left after settling
is an oscillation, whose fit is far smaller. In space, friction is not along a grid line; nodes with next to
no mass, beyond the faces, take 10⁴ steps and more to balance.
"""
# cost: 150

import math

import holding
from classical import LITERAL, MASTER, POSITION

from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Place, Runs, methods

#: Whose friction suffices: μ is larger.
SLOPE = math.tan(math.radians(20.0))
ON_LINES = {
    "bodies.block.geometry.lower": [0.5, 0.537, 0.5],
    "bodies.block.geometry.upper": [1.25, 0.912, 1.25],
    "bodies.plane.geometry.lower": [0.0, 0.0, 0.0],
    "bodies.plane.geometry.upper": [2.0, 0.537, 2.0],
}
USL = {"USL": {"stepping.scheme": "usl"}}
FORMS = {"criterion position": POSITION, "normal master": MASTER}

block = Runs(
    "block",
    methods=[
        *methods(shape=RECOMMENDED, when="quick"),
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(["bardenhagen"], SHAPES, FORMS, when="full"),
        *methods(["hamad2017"], settings={"": {}, "literal": LITERAL}, when="full"),
        *methods(["bardenhagen", "penalty"], ["linear"], USL, when="full"),
    ],
    set={"output.particles": False},
)
in_space = Runs(
    "in space",
    "in-space.toml",
    methods(["penalty", "bardenhagen"]),
    [
        Place("off the grid lines"),
        Place("faces on grid lines", ON_LINES, open={"way": "nodes beyond the faces have next to no mass"}),
    ],
    when="full",
)


@block
def test_block(run):
    run.gate("displacement after 2 s / height", run.of(holding.displacement), 0.0, (0.0, 1e-3))
    run.gate("fitted drift in the last second / height", run.of(holding.drift), 0.0, 1e-4)
    run.gate("T / N in the last second", run.of(holding.friction), SLOPE)


@in_space
def test_in_space(run):
    at, way, later = run.place.at, run.of(holding.creep, "way"), run.of(holding.creep, "later")
    run.gate(f"in space, {at}: way in 10⁴ steps", way, 0.0, (0.0, 1e-6), "h", key="way")
    run.gate(f"in space, {at}: change of it in the last 8000 steps", later, 0.0, unit="h")
