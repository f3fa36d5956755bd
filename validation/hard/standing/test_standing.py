"""Hard scenes: what stands by friction alone."""

# cost: 100

import made
from held import RESTS, held, place, scenes, scores

from mpmfw.validation import full, together

every = scenes(
    [
        place("card house", made.cards, lean=65),
        place("arch of 25 stones", made.arch, stones=25),
    ]
)


@every
def test_scene(run):
    held(run, RESTS)


@full
@together(every)
def test_scores(case, runs):
    scores(case, runs)
