"""Hard scenes: PolyFEM and IPC in the plane."""

# cost: 120

# Tip on tip: the right one is 0.013 aside, exactly opposite rounding decides to which side they go.

import closed
from common import disc, polygon, rectangle
from held import FRICTION, SYMMETRY, held, place, scenes, scored, shared
from made import BELOW, plane

VERTEX = {
    "energy": "error in time of springs that change at the corner, 0.67 %",
    "penetration": "a corner has the force of one node's spring: 0.23 cells",
}
SLOT = "error in time of a triangle that scrapes along both walls: 0.70 %, 0.14 % with half of the step"
CUSHION = {
    "penetration": "the pins' tips are single nodes in a cushion of 0.1 MPa: 1.01 cells",
    "symmetry": {"*": "a tip in the cushion grows what rounding leaves, with barriers and lcp as well"},
}
TIPS = (0.4, 0.2, 0.0, -0.2, -0.4)
#: Pins of 0.3 m on a block, and their tips' feet, from the right.
PINS = [
    *([-0.5, -0.1], [0.5, -0.1], [0.5, 0.0]),
    *(corner for x in TIPS for corner in ([round(x + 0.025, 3), 0.0], [x, 0.3], [round(x - 0.025, 3), 0.0])),
    [-0.5, 0.0],
]


def too_soft(depth):
    """Return the reason of springs that are too soft, and the depth."""
    return {"penetration": f"too soft springs: {depth} cells"}


def roller(x, spin):
    """Return a heavy roller that turns."""
    return disc(x, 0.0, 0.25, E=10e6, rho=20000.0, angular_velocity=spin)


every = scenes(
    [
        shared("five-squares", misses=too_soft(0.16)),
        shared("vertex-on-vertex", True, VERTEX, when=""),
        shared("golf-ball", True, {"penetration": "0.4 of the wave speed, too soft springs: 0.37 cells"}),
        shared("slot", True, {"energy": SLOT}),
        place(
            "triangles",
            sharp=True,
            when="",
            cell=0.1,
            end=0.4,
            gravity=0,
            left=polygon([[-0.02, 0.0], [-0.886, 0.5], [-0.886, -0.5]], velocity=[1.0, 0.0]),
            right=polygon([[0.02, 0.013], [0.886, -0.487], [0.886, 0.513]], velocity=[-1.0, 0.0]),
        ),
        place(
            "point-on-plane",
            sharp=True,
            misses={"penetration": "a corner has the force of one node's spring: 0.29 cells"},
            cell=0.1,
            end=0.6,
            floor=plane(-1.0, -0.3, 1.0, 0.0),
            square=rectangle(-0.5, 0.227, 0.5, 1.227, angle=0.7853981634),
        ),
        place(
            "ball on a thin wall",
            sharp=True,
            misses=too_soft(0.38),
            cell=0.0025,
            end=0.0004,
            gravity=0,
            ball=disc(-0.021, 0.0, 0.02, E=10e6, nu=0.45, rho=1150, velocity=[67.0, 0.0]),
            wall=rectangle(0.0, -0.04, 0.0025, 0.04, E=2e11, nu=0.3, rho=7850),
        ),
        place(
            "disc on a mat",
            cell=0.05,
            end=0.3,
            room=0.3,
            mat=rectangle(
                *(-1.0, -0.1, 1.0, 0.0),
                E=100e3,
                sides=[
                    {"side": "left", "velocity": [-0.28, 0.0]},
                    {"side": "right", "velocity": [0.28, 0.0]},
                ],
            ),
            disc=disc(0.0, 0.21, 0.2, E=10e6),
        ),
        place(
            "rollers",
            misses=too_soft(0.14),
            cell=0.05,
            end=0.4,
            friction=0.5,
            gravity=0,
            left=roller(-0.3, -4.0),
            right=roller(0.3, 4.0),
            disc=disc(0.0, 0.39, 0.15, E=100e3, velocity=[0.0, -1.0]),
        ),
        place(
            "pin cushion",
            sharp=True,
            misses=CUSHION,
            cell=0.05,
            end=0.2,
            pins=polygon(PINS, sides=BELOW, E=10e6),
            cushion=rectangle(-0.5, 0.31, 0.5, 0.71, E=100e3),
        ),
        place(
            "moving ground",
            set={"stepping.transfer": "flip", "stepping.pic_fraction": 0.05},
            cell=0.1,
            end=0.4,
            friction=0.5,
            gravity=[[0.0, 0.0, -9.81], [0.1, 8.0, -9.81]],
            settled=True,
            block=rectangle(0.03, 0.013, 0.63, 0.313, E=12e6, nu=0.3),
            plane=plane(-0.4, -0.187, 1.2, 0.013, E=30e6, nu=0.3),
        ),
    ]
)


@every
def test_scene(run):
    gates = []
    if run.at("moving ground"):
        gates = [("acceleration, error", closed.slides, 1.0, "%"), FRICTION]
    if run.at("rollers", "pin cushion", "point-on-plane", "disc on a mat"):
        gates = [SYMMETRY]
    held(run, *gates)


test_scores = scored(every)
