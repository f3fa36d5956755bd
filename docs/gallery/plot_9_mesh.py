"""
A body from a mesh file
=======================

Any closed surface of triangles can be a body: ``.stl``, ``.obj``, ``.ply``, ``.off`` or ``.msh``, with
``pip install "mpmfw[mesh]"``. Here trimesh writes the file, the surface of a chess pawn; usually a CAD
program does. The pawn is tilted and falls on a rigid floor."""

from pathlib import Path
from tempfile import mkdtemp

import trimesh

import mpmfw

profile = [(0.0, 0.0), (0.26, 0.0), (0.26, 0.1), (0.12, 0.22), (0.09, 0.5), (0.2, 0.55), (0.2, 0.62)]
profile += [(0.16, 0.64), (0.2, 0.74), (0.18, 0.84), (0.1, 0.92), (0.0, 0.94)]
pawn = trimesh.creation.revolve(profile, sections=20)
path = Path(mkdtemp()) / "pawn.stl"
pawn.export(path)
print(f"{len(pawn.faces)} triangles, {pawn.volume:.4f} m³, closed: {pawn.is_watertight}")

# %%
# ``angles`` turn the body about the axes of the grid, ``shift`` moves it. The file's axis is z.

scene = {
    "title": "Pawn",
    "grid": {"cell_size": 0.1, "lower": [-0.9, -0.2, -0.7], "upper": [0.7, 1.3, 0.7]},
    "time": {"end": 0.12, "output_interval": 0.006},
    "shape": {"method": "linear"},
    "contact": {"method": "penalty", "friction": 0.4},
    "materials": {
        "rubber": {
            "model": "neo_hookean",
            "density": 1000.0,
            "youngs_modulus": "1 MPa",
            "poissons_ratio": 0.3,
        }
    },
    "bodies": {
        "pawn": {
            "material": "rubber",
            "geometry": {
                "type": "surface_mesh",
                "path": str(path),
                "angles": ["-90 deg", 0.0, "20 deg"],
                "shift": [0.0, 0.12, 0.0],
            },
            "particles": {"size": "0.5 cells"},
            "velocity": [0.0, -3.0, 0.0],
        },
        "floor": {
            "geometry": {"type": "half_space", "point": [0.0, 0.0, 0.0], "normal": [0.0, 1.0, 0.0]},
            "rigid": True,
        },
    },
}
tree = mpmfw.run(scene)

# %%

film = mpmfw.animate(tree, path.with_suffix(".gif"), "von_mises", fps=10)
film

# %%
# The largest force of the floor on the pawn, the mean over an output interval:

force = abs(mpmfw.history(tree, "contact_force", pair="pawn-floor", axis="y"))
print(f"{1e-3 * float(force.max()):.1f} kN at {float(force.idxmax()):.3f} s")
