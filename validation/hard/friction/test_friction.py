"""Hard scenes: the friction suite of robotics."""

# cost: 120

# Open is what penalty contact with CPDI, plain or in its strongest form (held.py), does not hold today,
# with the reason; it is shown and decides nothing. Drawn along the incline, whose slope is 0.1; pushed
# with 0.6 of its weight.

import closed
import criteria
from held import held, scenes, scores

from mpmfw.validation import Place, full, together

every = scenes(
    [
        Place("stopping-0.1", scene="../scenes/stopping-0.1.toml", when="full"),
        Place("stopping-0.3", scene="../scenes/stopping-0.3.toml", when="full"),
        Place("stopping-0.5", scene="../scenes/stopping-0.5.toml"),
        Place(
            "slide to roll",
            make={
                "cell": 0.1,
                "end": 0.6,
                "friction": 0.2,
                "gravity": 10.0,
                "settled": True,
                "bodies": {
                    "disc": {
                        "disc": [0.03, 0.413, 0.4],
                        "E": 15.4e6,
                        "nu": 0.286,
                        "velocity": [3.0, 0.0],
                    },
                    "plane": {
                        "box": [-0.4, -0.187, 2.2, 0.013],
                        "E": 30.8e6,
                        "nu": 0.286,
                        "fixed": "bottom",
                    },
                },
            },
        ),
        Place(
            "sliding wedge",
            make={
                "cell": 0.1,
                "end": 0.45,
                "friction": 0.3,
                "gravity": [-0.995037, -9.950372],
                "settled": True,
                "outputs": 90,
                "bodies": {
                    "wedge": {"box": [0.03, 0.013, 0.63, 0.313], "E": 15.4e6, "nu": 0.286},
                    "plane": {
                        "box": [-0.2, -0.187, 1.1, 0.013],
                        "E": 30.8e6,
                        "nu": 0.286,
                        "fixed": "bottom",
                    },
                },
                "loads": {
                    "push": {
                        "model": "body_force",
                        "bodies": ["wedge"],
                        "force": [[0.0, 0.0, 0.0], [0.1, 5970.22, -597.022]],
                    }
                },
            },
            when="full",
        ),
    ]
)


@every
def test_scene(run):
    held(run)
    at = run.place.at
    if run.at("stopping*"):
        run.gate(
            f"{at}: stopping distance, error",
            run.of(closed.stops, "stops"),
            tolerance=0.5,
            unit="%",
            key="stops",
        )
    if run.at("slide to roll"):
        run.gate(
            f"{at}: speed and spin of rolling, error",
            run.of(closed.rolls, "rolls"),
            tolerance=0.5,
            unit="%",
            key="rolls",
        )
    if run.at("sliding wedge"):
        run.gate(
            f"{at}: force over weight, error",
            run.of(closed.climbs, "climbs"),
            tolerance=1.0,
            unit="%",
            key="climbs",
        )
    if run.at("stopping*", "sliding wedge"):
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
