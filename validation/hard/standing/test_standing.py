"""Hard scenes: what stands by friction alone."""

# cost: 100

import made
from held import RESTS, held, place, scenes, scored

every = scenes(
    [
        place("card house", made.cards, lean=65),
        place("arch of 25 stones", made.arch, stones=25),
    ]
)


@every
def test_scene(run):
    held(run, RESTS)


test_scores = scored(every)
