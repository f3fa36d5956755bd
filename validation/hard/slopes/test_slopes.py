"""Hard scenes: blocks on slopes."""

# cost: 150

# A plane twice as stiff as the block has a normal of its own for the contacts that take the stiffer
# body's. The closed form is a rigid block's: a twentieth of PIC, for every method, takes the flutter that
# an undamped elastic one has. Newton's grid of five mu by five theta, 25 scenes.

import closed
import made
from held import FRICTION, held, place, scenes, scored

#: Also in the reduced version.
QUICK = ((0.7, 40), (0.7, 50))
every = scenes(
    [
        *(
            place(
                f"mu {friction}, {tilt} deg",
                made.incline,
                when="" if (friction, tilt) in QUICK else "full",
                friction=friction,
                tilt=tilt,
            )
            for friction in (0.1, 0.3, 0.5, 0.7, 0.9)
            for tilt in (10, 20, 30, 40, 50)
        ),
        *(place(f"slope, mu {mu}", made.incline, friction=mu, tilt=26.565) for mu in (0.49, 0.51)),
    ],
    set={
        "output.surface": False,
        "materials.plane.youngs_modulus": 30.8e6,
        "stepping.transfer": "flip",
        "stepping.pic_fraction": 0.05,
    },
)
GATES = (
    ("acceleration, error", closed.slides, 1.0, "%"),
    ("creep", closed.creeps, (0.0, 1.0), "mm/s"),
    FRICTION,
)


@every
def test_scene(run):
    held(run, *GATES)


test_scores = scored(every)
