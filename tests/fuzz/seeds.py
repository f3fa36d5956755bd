"""Small valid scenes that mutants are made from: between them they name every table and most keys."""

import functools

from mpmfw.scene.toml_text import toml_text
from scenes_for_tests import one_body, solid, with_changes

SOFT = {"model": "neo_hookean", "density": "1 g/cm^3", "bulk_modulus": "1 MPa", "shear_modulus": 5e5}
HARD = {"model": "linear_elastic", "density": 2000.0, "bulk_modulus": 2e6, "shear_modulus": 1e6}


def scene(geometry, shape, **changes):
    """A body of a few points in cells of half a metre, for two outputs."""
    time = {"end": "1 ms", "output_interval": 5e-4, "safety": 0.4}
    made = one_body(geometry, size=0.25, shape__method=shape, materials__soft=SOFT, time=time)
    return with_changes(made, grid__cell_size=0.5, **changes)


def two(contact, shape):
    """A disc on a floor, with most of what two bodies may have."""
    disc = {"type": "disc", "centre": [0.2, 0.61], "radius": 0.5}
    made = scene(
        disc,
        shape,
        grid={"cell_size": 0.5, "lower": [-2.0, -1.5], "upper": [3.0, "2500 mm"]},
        stepping={"scheme": "auto", "transfer": "auto"},
        contact={"method": contact, "friction": 0.1},
        contact__pairs=[{"bodies": ["solid", "floor"], "friction": 0.3}],
        materials__hard=HARD,
        bodies__solid__particles={"layout": "lattice", "size": "0.5 cells", "offset": [0.1, 0.2]},
        bodies__solid__velocity=[1.0, -2.0],
        bodies__solid__angular_velocity=3.0,
        gravity={"magnitude": 9.81, "tilt": "30 deg"},
        output=dict.fromkeys(("gap", "particles", "surface", "energy", "ledger", "stability"), True),
    )
    sides = [{"side": "bottom", "fixed": True}, {"side": "right", "velocity": [0.0, "free"]}]
    made["bodies"]["floor"] = solid(
        *([-1.0, -0.5], [1.5, 0.1], "0.5 cells", "hard", "fitted"),
        segment="0.25 cells", rotation="lumped", sides=sides,
    )  # fmt: skip
    return made


HOLE = [[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]]
SEEDS = {
    "penalty": two("penalty", "cpdi"),
    "bardenhagen": two("bardenhagen", "bspline"),
    "one": scene(
        {"type": "ring", "centre": [0.5, 0.5], "inner_radius": 0.4, "outer_radius": 0.8},
        "linear",
        title="A ring that settles",
        allow_unstable=True,
        allow_overlap=True,
        stepping={"transfer": "flip", "pic_fraction": 0.01},
        gravity={"table": [[0.0, 0.0, -9.81], [1.0, 1.0, 0.0]]},
        settle={"tolerance": 0.5, "max_time": "1 ms", "gravity": {"vector": [0.0, -5.0]}},
    ),
    "plate": scene(
        {"type": "polygon", "points": [[0, 0], [1, 0], [1, 1], [0, 1]], "holes": [HOLE]},
        "gimp",
        bodies__solid__sides=[{"side": "left", "fixed": ["x"]}],
        gravity={"vector": [1.0, "-9.81 m/s^2"]},
    ),
    "space": scene(
        {"type": "ball", "centre": [0.03, 0.04, 0.05], "radius": 0.6},
        "linear",
        time={"end": 1e-3, "output_interval": 1e-3, "step": 1e-4},
        stepping={"transfer": "tpic"},
        bodies__solid__particles={"size": 0.4},
        bodies__solid__velocity=[0, 0, 1],
        bodies__solid__angular_velocity=[0, 1, 0],
    ),
}


@functools.cache
def seeds():
    """Name and TOML text of every seed."""
    return [(name, toml_text(mapping)) for name, mapping in SEEDS.items()]
