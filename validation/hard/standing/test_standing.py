"""Hard scenes: what stands by friction alone."""

# cost: 100

# Open is what penalty contact with CPDI, plain or in its strongest form (held.py), does not hold today,
# with the reason; it is shown and decides nothing.

import closed
import made
from held import held, scenes, scores

from mpmfw.validation import Place, full, together

every = scenes(
    [
        Place("card house", scene=made.cards, make={"lean": 65}, when="full"),
        Place("arch of 25 stones", scene=made.arch, make={"stones": 25}, when="full"),
    ]
)


@every
def test_scene(run):
    held(run)
    at = run.place.at
    run.gate(
        f"{at}: drift at rest",
        run.of(closed.rests, "rests"),
        tolerance=(0.0, 0.01),
        unit="cells",
        key="rests",
    )


@full
@together(every)
def test_scores(case, runs):
    scores(case, runs)
