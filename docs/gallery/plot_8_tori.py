"""
Two linked rings in space
=========================

Two rubber rings are linked like those of a chain. One is thrown towards the other, until they meet inside
each other's holes. In 3D, ``pip install "mpmfw[render]"`` draws bodies as surfaces."""

from pathlib import Path
from tempfile import mkdtemp

import mpmfw

ring = {"material": "rubber", "particles": {"size": "0.5 cells"}}
scene = {
    "title": "Linked rings",
    "grid": {"cell_size": 0.1, "lower": [-1.1, -0.7, -0.7], "upper": [1.1, 0.7, 0.7]},
    "time": {"end": 0.08, "output_interval": 0.004},
    "shape": {"method": "linear"},
    "contact": {"method": "penalty", "friction": 0.2, "penalty": {"kappa": 8.0}},
    "materials": {
        "rubber": {
            "model": "neo_hookean",
            "density": 1000.0,
            "youngs_modulus": "1 MPa",
            "poissons_ratio": 0.3,
        }
    },
    "bodies": {
        "left": ring
        | {"geometry": {"type": "torus", "centre": [0.0, 0.0, 0.0], "radius": 0.4, "tube_radius": 0.12}},
        "right": ring
        | {
            "geometry": {
                "type": "torus",
                "centre": [0.4, 0.0, 0.0],
                "radius": 0.4,
                "tube_radius": 0.12,
                "axis": "y",
            },
            "velocity": [-6.0, 0.0, 0.0],
        },
    },
}
tree = mpmfw.run(scene)

# %%

film = mpmfw.animate(tree, Path(mkdtemp()) / "rings.gif", "von_mises", fps=10)
film

# %%
# The rings exchange momentum when they meet; their sum stays.

momentum = mpmfw.history(tree, "linear_momentum", axis="x")
print(momentum.isel(time=[0, -1]).to_pandas().round(3))
