"""Hard scenes: the friction suite of robotics."""

# cost: 120

# Drawn along the incline, whose slope is 0.1; pushed with 0.6 of its weight.

import closed
from common import disc, rectangle
from held import FRICTION, held, place, scenes, scored, shared
from made import force, plane

BLOCK = {"E": 15.4e6, "nu": 0.286}
PLANE = {"E": 30.8e6, "nu": 0.286}

every = scenes(
    [
        shared("stopping-0.1"),
        shared("stopping-0.3"),
        shared("stopping-0.5", when=""),
        place(
            "slide to roll",
            when="",
            cell=0.1,
            end=0.6,
            friction=0.2,
            gravity=10.0,
            settled=True,
            disc=disc(0.03, 0.413, 0.4, velocity=[3.0, 0.0], **BLOCK),
            plane=plane(-0.4, -0.187, 2.2, 0.013, **PLANE),
        ),
        place(
            "sliding wedge",
            cell=0.1,
            end=0.45,
            friction=0.3,
            gravity=[-0.995037, -9.950372],
            settled=True,
            outputs=90,
            wedge=rectangle(0.03, 0.013, 0.63, 0.313, **BLOCK),
            plane=plane(-0.2, -0.187, 1.1, 0.013, **PLANE),
            loads={"push": force("wedge", [0.0, 0.0, 0.0], [0.1, 5970.22, -597.022])},
        ),
    ]
)
#: Where a gate holds, its quantity, function, limits and unit.
GATES = (
    (("stopping*",), "stopping distance, error", closed.stops, 0.5, "%"),
    (("slide to roll",), "speed and spin of rolling, error", closed.rolls, 0.5, "%"),
    (("sliding wedge",), "force over weight, error", closed.climbs, 1.0, "%"),
    (("stopping*", "sliding wedge"), *FRICTION),
)


@every
def test_scene(run):
    held(run, *(gate for places, *gate in GATES if run.at(*places)))


test_scores = scored(every)
