"""
How large a step, how stiff a spring
====================================

Contact springs shorten the stable time step. Every point of the map is a run of two blocks that collide, with
a fixed step, classed by the energy that it makes; :doc:`/docs/guide/stability` says how. A tiny map, of a
hundred steps a run."""

from mpmfw.plots.stability import stability_figures
from mpmfw.stability import stability_map

scene = {
    "grid": {"cell_size": 0.1, "lower": [-0.4, -0.4], "upper": [1.6, 0.8]},
    "time": {"end": 1.0, "output_interval": 1.0},
    "shape": {"method": "cpdi"},
    "contact": {"method": "penalty"},
    "materials": {
        "soft": {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 1e6, "shear_modulus": 5e5}
    },
    "bodies": {
        "left": {
            "material": "soft",
            "geometry": {"type": "rectangle", "lower": [0.0, 0.0], "upper": [0.4, 0.4]},
            "particles": {"size": "0.5 cells"},
            "segment": "0.25 cells",
            "velocity": [0.5, 0.0],
        },
        "right": {
            "material": "soft",
            "geometry": {"type": "rectangle", "lower": [0.402, 0.0], "upper": [0.802, 0.4]},
            "particles": {"size": "0.5 cells"},
            "segment": "0.25 cells",
            "velocity": [-0.5, 0.0],
        },
    },
}
chart = stability_map(scene, kappa=[0.5, 1.0, 2.0, 4.0, 8.0], cfl=[0.2, 0.4, 0.6, 0.8], steps=100)

# %% The line is the closed form for two equal bodies, :math:`1/\sqrt{1 + \kappa}` in Courant numbers; a run
# of mpmfw takes half of the least limit that its nodal masses give, in every step anew.

((figure, caption),) = stability_figures(chart).values()
figure

# %%
# The numbers behind it:

chart["energy"].to_pandas()
