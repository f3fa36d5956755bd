"""Hard scenes: blocks on slopes."""

# cost: 150

# Open is what penalty contact with CPDI, plain or in its strongest form (held.py), does not hold today,
# with the reason; it is shown and decides nothing. A plane twice as stiff as the block has a normal of
# its own for the contacts that take the stiffer body's. The closed form is a rigid block's: a twentieth
# of PIC, for every method, takes the flutter that an undamped elastic one has. Newton's grid of five mu
# by five theta, 25 scenes.

import closed
import criteria
import made
from held import held, scenes, scores

from mpmfw.validation import Place, full, together

every = scenes(
    [
        *(
            Place(
                f"mu {friction}, {tilt} deg",
                scene=made.incline,
                make={"friction": friction, "tilt": tilt},
                when="full",
            )
            for friction in (0.1, 0.3)
            for tilt in (10, 20, 30, 40, 50)
        ),
        *(
            Place(
                f"mu 0.5, {tilt} deg", scene=made.incline, make={"friction": 0.5, "tilt": tilt}, when="full"
            )
            for tilt in (10, 20, 40, 50)
        ),
        *(
            Place(
                f"mu 0.7, {tilt} deg", scene=made.incline, make={"friction": 0.7, "tilt": tilt}, when="full"
            )
            for tilt in (10, 20, 30)
        ),
        *(
            Place(
                f"mu 0.9, {tilt} deg", scene=made.incline, make={"friction": 0.9, "tilt": tilt}, when="full"
            )
            for tilt in (10, 20, 30, 40)
        ),
        Place("mu 0.5, 30 deg", scene=made.incline, make={"friction": 0.5, "tilt": 30}, when="full"),
        *(
            Place(f"mu 0.7, {tilt} deg", scene=made.incline, make={"friction": 0.7, "tilt": tilt})
            for tilt in (40, 50)
        ),
        Place("mu 0.9, 50 deg", scene=made.incline, make={"friction": 0.9, "tilt": 50}, when="full"),
        Place("slope, mu 0.49", scene=made.incline, make={"tilt": 26.565, "friction": 0.49}, when="full"),
        Place("slope, mu 0.51", scene=made.incline, make={"tilt": 26.565, "friction": 0.51}, when="full"),
    ],
    set={
        "output.surface": False,
        "materials.plane.youngs_modulus": 30.8e6,
        "stepping.transfer": "flip",
        "stepping.pic_fraction": 0.05,
    },
)


@every
def test_scene(run):
    held(run)
    at = run.place.at
    run.gate(
        f"{at}: acceleration, error", run.of(closed.slides, "slides"), tolerance=1.0, unit="%", key="slides"
    )
    run.gate(f"{at}: creep", run.of(closed.creeps, "creeps"), tolerance=(0.0, 1.0), unit="mm/s", key="creeps")
    run.gate(
        f"{at}: T/(mu N)",
        run.of(criteria.friction, "friction"),
        tolerance=(0.0, 1.0001),
        unit="1",
        key="friction",
    )


@full
@together(every)
def test_scores(case, runs):
    scores(case, runs)
