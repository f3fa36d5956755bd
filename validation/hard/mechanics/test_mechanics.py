"""Hard scenes: contact mechanics."""

# cost: 120

# Open is what penalty contact with CPDI, plain or in its strongest form (held.py), does not hold today,
# with the reason; it is shown and decides nothing. The front must be resolved: -1.9 % with cells of
# 0.02, -1.1 % of 0.01, -0.64 % of 0.005.

import closed
import criteria
from held import held, scenes, scores

from mpmfw.validation import Place, full, together

every = scenes(
    [
        Place(
            "flat punch",
            set={"output.surface": True},
            make={
                "cell": 0.125,
                "end": 0.002,
                "gravity": 1.0,
                "settled": True,
                "outputs": 2,
                "room": 0.2,
                "bodies": {
                    "ground": {"box": [-4.0, -6.0, 4.0, 0.0], "E": 10e6, "nu": 0.3, "fixed": "bottom"},
                    "punch": {"box": [-1.0, 0.0, 1.0, 1.0], "E": 1e9, "nu": 0.3, "rho": 10000.0},
                },
            },
            within={"penetration": (0.0, 0.2)},
            open={
                "presses": {
                    "penalty, cpdi": (
                        "soft springs share out the edges' pressure: 12 %, in cells twice as "
                        "large 18 and 7.7 with 16 times the stiffness"
                    )
                }
            },
            when="full",
        ),
        *(
            Place(
                f"punch with rounded edges, mu {friction:g}",
                make={
                    "cell": 0.01,
                    "end": 0.0001,
                    "gravity": 0,
                    "room": 0.2,
                    "bodies": {
                        "ground": {
                            "box": [-0.1, -0.2, 0.1, 0.0],
                            "E": 7e10,
                            "nu": 0.3,
                            "rho": 2700,
                            "fixed": "bottom",
                        },
                        "punch": {
                            "points": [
                                [-0.04, 0.0],
                                [0.04, 0.0],
                                [0.045, 0.00134],
                                [0.0487, 0.005],
                                [0.05, 0.01],
                                [0.05, 0.1],
                                [-0.05, 0.1],
                                [-0.05, 0.01],
                                [-0.0487, 0.005],
                                [-0.045, 0.00134],
                            ],
                            "E": 2.1e11,
                            "nu": 0.3,
                            "rho": 7850,
                        },
                    },
                    "loads": {
                        "press": {
                            "model": "body_force",
                            "bodies": ["punch"],
                            "force": [[0.0, 0.0, 0.0], [5e-05, 0.0, -1e9]],
                        }
                    },
                    "friction": friction,
                },
                within={"penetration": (0.0, 0.2)},
                when="full",
            )
            for friction in (0, 0.1)
        ),
        Place(
            "sliding reversal",
            set={"stepping.transfer": "flip", "stepping.pic_fraction": 0.05},
            make={
                "cell": 0.1,
                "end": 0.4,
                "friction": 0.3,
                "settled": True,
                "gravity": [
                    [0.0, 0.0, -10.0],
                    [0.05, 8.0, -10.0],
                    [0.1, 8.0, -10.0],
                    [0.15, -8.0, -10.0],
                    [0.3, -8.0, -10.0],
                    [0.35, 8.0, -10.0],
                ],
                "bodies": {
                    "block": {"box": [0.03, 0.013, 0.63, 0.313], "E": 154e6, "nu": 0.286},
                    "plane": {
                        "box": [-0.3, -0.187, 1.0, 0.013],
                        "E": 308e6,
                        "nu": 0.286,
                        "fixed": "bottom",
                    },
                },
            },
            when="full",
        ),
        Place(
            "unequal bars",
            make={
                "cell": 0.005,
                "end": 0.12,
                "gravity": 0,
                "outputs": 60,
                "bodies": {
                    "short": {"box": [-0.51, -0.05, -0.01, 0.05], "nu": 0.0, "velocity": [0.2, 0.0]},
                    "long": {"box": [0.0, -0.05, 1.0, 0.05], "nu": 0.0},
                },
            },
        ),
        Place(
            "pushed block",
            make={
                "cell": 0.005,
                "end": 0.004,
                "friction": 0.3,
                "gravity": 0,
                "bodies": {
                    "block": {
                        "box": [0.001, 0.0, 0.041, 0.015],
                        "E": 1e9,
                        "nu": 0.3,
                        "sides": [
                            {"side": "top", "pressure": [[0.0, 0.0], [0.0002, 100e3]]},
                            {"side": "left", "pressure": [[0.0, 0.0], [0.0002, 0.0], [0.0006, 315.3e3]]},
                        ],
                    },
                    "plane": {
                        "box": [-0.01, -0.015, 0.11, 0.0],
                        "E": 2e9,
                        "nu": 0.3,
                        "fixed": "bottom",
                    },
                },
            },
            when="full",
        ),
        Place(
            "two discs",
            make={
                "cell": 0.05,
                "end": 3.0,
                "gravity": 0,
                "bodies": {
                    "left": {"disc": [0.2, 0.2, 0.2], "E": 1000, "nu": 0.3, "velocity": [0.1, 0.1]},
                    "right": {"disc": [0.8, 0.8, 0.2], "E": 1000, "nu": 0.3, "velocity": [-0.1, -0.1]},
                },
            },
            open={"penetration": {"penalty, cpdi": "0.24 of the wave speed: 0.23 cells"}},
        ),
        Place(
            "bounce",
            make={
                "cell": 0.025,
                "end": 0.12,
                "gravity": 0,
                "outputs": 40,
                "bodies": {
                    "disc": {"disc": [0.0, 0.103, 0.1], "E": 10e6, "nu": 0.3, "velocity": [0.0, -0.2]},
                    "floor": {"box": [-0.2, -0.1, 0.2, 0.0], "E": 100e6, "nu": 0.3, "fixed": "bottom"},
                },
            },
            open={
                "bounces": (
                    "-2.0 %; -0.9 % with half of the cells: what stiff springs shake the "
                    "transfer takes, -4.9 % with 16 times the stiffness"
                )
            },
            when="full",
        ),
        Place(
            "heavy disc on a light one",
            make={
                "cell": 0.05,
                "end": 0.1,
                "bodies": {
                    "floor": {"box": [-0.4, -0.1, 0.4, 0.0], "E": 100e6, "fixed": "bottom"},
                    "light": {"disc": [0.0, 0.202, 0.2], "E": 10e6, "rho": 100},
                    "heavy": {"disc": [0.0, 0.604, 0.2], "E": 10e6, "rho": 10000},
                },
            },
            when="full",
        ),
    ]
)


#: Where a gate holds, the quantity, its function, key, limits and unit.
GATES = (
    (["flat punch"], "force under the middle half, error", closed.presses, "presses", 5.0, "%"),
    (["sliding reversal"], "way at the end, error", closed.reverses, "reverses", 1.0, "%"),
    (["unequal bars"], "momentum that the short one keeps", closed.hands_over, "hands_over", 1.0, "%"),
    (["pushed block"], "acceleration, error", closed.pushed, "pushed", 1.0, "%"),
    (["bounce"], "speed after over before, error", closed.bounces, "bounces", 0.1, "%"),
    (
        ["sliding reversal", "pushed block"],
        "T/(mu N)",
        criteria.friction,
        "friction",
        (0.0, 1.0001),
        "1",
    ),
    (
        ["flat punch", "punch with rounded edges*", "heavy disc*"],
        "departure from mirror symmetry",
        criteria.symmetry,
        "symmetry",
        (0.0, 1e-06),
        "cells",
    ),
)


@every
def test_scene(run):
    held(run)
    at = run.place.at
    for places, quantity, of, key, tolerance, unit in GATES:
        pressed_by_springs = key != "presses" or run.method.matches("penalty, *", "penalty(*")
        if run.at(*places) and pressed_by_springs:
            run.gate(f"{at}: {quantity}", run.of(of, key), tolerance=tolerance, unit=unit, key=key)


@full
@together(every)
def test_scores(case, runs):
    scores(case, runs)
