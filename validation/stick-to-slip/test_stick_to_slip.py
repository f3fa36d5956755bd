"""Stick to slip."""
# cost: 65

# The time at which a block under a rising tangential load has slid, for every contact and every shape
# function. Friction of [H17] to the letter, at the default step and at a quarter of it; both slide
# within the first 0.4 s. Over the time of slip, the smaller one of the two: the stricter reading.

import slipping

from mpmfw.validation import CONTACTS, RECOMMENDED, SHAPES, Runs, methods

scene = Runs(
    "",
    methods=[
        *methods(["bardenhagen", "penalty"], RECOMMENDED, when="quick"),
        *methods(CONTACTS, SHAPES, when="full"),
        *methods(
            ["bardenhagen"],
            ["gimp", "cpdi"],
            settings={
                "criterion position": {"contact.bardenhagen.criterion": "position"},
                "normal master": {"contact.bardenhagen.normal": "master"},
                "normal specified": {
                    "contact.bardenhagen.normal": "specified",
                    "contact.bardenhagen.direction": [0.0, -1.0],
                },
            },
            when="full",
        ),
        *methods(
            ["hamad2017"],
            settings={
                "": {},
                "literal, step x 1": {
                    "contact.hamad2017.friction_law": "literal",
                    "time.safety": 0.5,
                    "time.end": 0.6,
                },
                "literal, step x 0.25": {
                    "contact.hamad2017.friction_law": "literal",
                    "time.safety": 0.125,
                    "time.end": 0.6,
                },
            },
            when="full",
        ),
    ],
    set={"output.particles": False},
    quick={
        "gravity": {"table": [[0.0, 0.0, -10.0], [1.0, 4.5, -10.0]]},
        "time.end": 0.8,
        "time.output_interval": 0.005,
    },
)


@scene
def test_scene(run):
    run.gate(
        "time at which 1e-3 of the length is slid, error",
        run.of(slipping.time_of_slip, scale=100.0),
        0.0,
        2.0,
        "%",
    )
    run.gate("slid at 0.9 of the slip load / threshold", run.of(slipping.slid_before), 0.0, unit="%")
    run.gate("T / N at the end", run.of(slipping.friction_at_end), 0.3)
