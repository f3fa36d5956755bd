"""Small valid scenes that mutants are made from: between them they name every table and most keys."""

from __future__ import annotations

from typing import Any

_HEAD = """
[grid]
cell_size = 0.5
lower = [-2.0, -1.5]
upper = [3.0, "2500 mm"]

[time]
end = "1 ms"
output_interval = 5e-4
safety = 0.4

[shape]
method = "{shape}"

[materials.soft]
model = "neo_hookean"
density = "1 g/cm^3"
bulk_modulus = "1 MPa"
shear_modulus = 5e5
"""

_TWO = """
[stepping]
scheme = "auto"
transfer = "auto"

[contact]
method = "{contact}"
friction = 0.1

[[contact.pairs]]
bodies = ["upper", "floor"]
friction = 0.3

[materials.hard]
model = "linear_elastic"
density = 2000.0
bulk_modulus = 2e6
shear_modulus = 1e6

[bodies.upper]
material = "soft"
geometry = {{ type = "disc", centre = [0.2, 0.61], radius = 0.5 }}
particles = {{ layout = "lattice", size = "0.5 cells", offset = [0.1, 0.2] }}
velocity = [1.0, -2.0]
angular_velocity = 3.0

[bodies.floor]
material = "hard"
geometry = {{ type = "rectangle", lower = [-1.0, -0.5], upper = [1.5, 0.1] }}
particles = {{ layout = "fitted", size = "0.5 cells" }}
segment = "0.25 cells"
rotation = "lumped"
sides = [{{ side = "bottom", fixed = true }}, {{ side = "right", velocity = [0.0, "free"] }}]

[gravity]
magnitude = 9.81
tilt = "30 deg"

[output]
gap = true
particles = true
surface = true
energy = true
ledger = true
stability = true
"""

_ONE = """
title = "A ring that settles"
allow_unstable = true
allow_overlap = true

[stepping]
transfer = "flip"
pic_fraction = 0.01

[bodies.ring]
material = "soft"
geometry = { type = "ring", centre = [0.5, 0.5], inner_radius = 0.4, outer_radius = 0.8 }
particles = { size = 0.25 }

[gravity]
table = [[0.0, 0.0, -9.81], [1.0, 1.0, 0.0]]

[settle]
tolerance = 0.5
max_time = "1 ms"
gravity = { vector = [0.0, -5.0] }
"""

_SPACE = """
[grid]
cell_size = 0.5
lower = [-1.5, -1.5, -1.5]
upper = [1.5, 1.5, 1.5]

[time]
end = 1e-3
output_interval = 1e-3
step = 1e-4

[shape]
method = "linear"

[stepping]
transfer = "tpic"

[materials.soft]
model = "neo_hookean"
density = 1000
bulk_modulus = "1 MPa"
shear_modulus = "0.5 MPa"

[bodies.ball]
material = "soft"
geometry = { type = "ball", centre = [0.03, 0.04, 0.05], radius = 0.6 }
particles = { size = 0.4 }
velocity = [0, 0, 1]
angular_velocity = [0, 1, 0]
"""

_PLATE = """
[bodies.plate]
material = "soft"
geometry = { type = "polygon", points = [[0, 0], [1, 0], [1, 1], [0, 1]], holes = [[[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]]] }
particles = { size = 0.3 }
sides = [{ side = "left", fixed = ["x"] }]

[gravity]
vector = [1.0, "-9.81 m/s^2"]
"""  # noqa: E501


def seeds() -> list[tuple[str, str]]:
    """Name and TOML text of every seed."""

    def head(shape: str) -> str:
        return _HEAD.format(shape=shape)

    found: dict[str, Any] = {
        "penalty": head("cpdi") + _TWO.format(contact="penalty"),
        "bardenhagen": head("bspline") + _TWO.format(contact="bardenhagen"),
        "one": "\n".join(
            [_ONE[: _ONE.index("[stepping]")], head("linear"), _ONE[_ONE.index("[stepping]") :]]
        ),
        "plate": head("gimp") + _PLATE,
        "space": _SPACE,
    }
    return list(found.items())
