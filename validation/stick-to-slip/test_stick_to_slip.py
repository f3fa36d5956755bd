"""Stick to slip: the time at which a block under a rising tangential load has slid, for every method.

Friction of [H17] to the letter, at the default step and at a quarter of it; both slide within the first 0.4
s. Over the time of slip, the smaller one of the two: the stricter reading.
"""
# cost: 65

import slipping
from classical import LITERAL, MASTER, POSITION, specified

from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Runs, methods

SHORT = {**LITERAL, "time.end": 0.6}
CLASSICAL = {
    "criterion position": POSITION,
    "normal master": MASTER,
    "normal specified": specified(0.0, -1.0),
}
STEPS = {
    "": {},
    "literal, step x 1": {**SHORT, "time.safety": 0.5},
    "literal, step x 0.25": {**SHORT, "time.safety": 0.125},
}

block = Runs(
    "block",
    methods=[
        *methods(shape=RECOMMENDED, when="quick"),
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(["bardenhagen"], ["gimp", "cpdi"], CLASSICAL, when="full"),
        *methods(["hamad2017"], settings=STEPS, when="full"),
    ],
    set={"output.particles": False},
    quick={
        "gravity": {"table": [[0.0, 0.0, -10.0], [1.0, 4.5, -10.0]]},
        "time.end": 0.8,
        "time.output_interval": 0.005,
    },
)


@block
def test_block(run):
    time = run.of(slipping.time_of_slip, scale=100.0)
    run.gate("time at which 1e-3 of the length is slid, error", time, 0.0, 2.0, "%")
    run.gate("slid at 0.9 of the slip load / threshold", run.of(slipping.slid_before), 0.0, unit="%")
    run.gate("T / N at the end", run.of(slipping.friction_at_end), 0.3)
