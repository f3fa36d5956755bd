"""Hard scenes: Rigid-IPC in the plane."""

# cost: 120

import links
import made
from common import disc
from held import RESTS, held, place, scenes, scored

#: Reasons for the energy's error, which is one in time.
TEETH = (
    "error in time of teeth one cell high, which touch and part within a step: 1.0 % of a fall of 0.025 m, "
    "0.35 % with half of the step"
)
FACES = "springs of whole faces that touch within a step: 1.0 %; the transfer takes half of the energy"
FAST = {
    "penetration": "0.2 of the wave speed: 0.28 cells",
    "energy": "error in time, 0.55 %: 0.24 % with half of the step",
}
COGS = "error in time of teeth one cell wide: 0.53 %"

every = scenes(
    [
        place("saws of 10 teeth", made.saws, True, {"energy": TEETH}, teeth=10),
        place("saws of 100 teeth", made.saws, True, {"energy": "as with ten teeth: 0.62 %"}, teeth=100),
        place("plates hit at 100 m/s", made.stack, misses={"energy": FACES}, plates=10, speed=100),
        place("plates hit at 1000 m/s", made.stack, misses=FAST, plates=10, speed=1000),
        place("newton's cradle", made.cradle, when="", discs=4),
        place("cogs", made.cogs, True, {"energy": COGS}, teeth=8),
        place(
            "axle",
            cell=0.05,
            end=0.4,
            gravity=0,
            friction=0.1,
            hub=made.ring(0.21, 0.4, angular_velocity=3.0),
            axle=disc(0.0, 0.0, 0.2, velocity=[0.5, 0.0]),
        ),
        place("tower of five", made.piled, rows=[1, 1, 1, 1, 1]),
        place("pyramid of ten", made.piled, rows=[4, 3, 2, 1]),
        place("box filled with 100 discs", made.filling, across=10, discs=100),
        place("chain of 4 links", links.chain, True, links=4),
        place("compactor", made.compactor, misses={"penetration": "too soft springs: 0.13 cells"}),
    ]
)


@every
def test_scene(run):
    held(run, *([RESTS] if run.at("tower*", "pyramid*") else []))


test_scores = scored(every)
