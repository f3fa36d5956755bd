"""
A footing on clay: settlement and limit load
============================================

A rigid, rough strip is pushed into clay that yields without changing its volume. The load it can carry is
Prandtl's, :math:`(2 + \\pi)\\,c_u B`. The cells are twice those of the shipped scene, four to the width."""

import matplotlib.pyplot as plt
import numpy as np

import mpmfw
from mpmfw.plots.style import dress, new_figure

plt.style.use("mpmfw.plots.journal")

changes = {"grid.cell_size": 0.25, "output.particles": True}
tree = mpmfw.run("footing", set=changes)

# %%
# Equivalent plastic strain
# -------------------------
# A wedge below the footing goes down with it and pushes the clay beside it outwards and up.

figure = mpmfw.plots.field(tree, "plastic_strain", bodies=["soil"])
figure

# %%
# Load over settlement
# --------------------
# ``mpmfw.history`` gives any series of a run. Nodes beside the edges carry load too, as if the strip were
# wider. The load is therefore too high; it falls as cells get smaller.

load = -1e-3 * mpmfw.history(tree, "reaction", body="footing", axis="y")
height = mpmfw.history(tree, "centre_of_mass", body="footing", axis="y")
prandtl = 1e-3 * (2.0 + np.pi) * 17320.508 / np.sqrt(3.0)
figure = new_figure(1, 1)
axes = figure.subplots()
axes.plot(1e3 * (height[0] - height), abs(load), label="penalty, four cells wide")
axes.axhline(prandtl, color="black", linewidth=0.8, linestyle="--", label="Prandtl")
dress(axes, "settlement [mm]", "load [kN/m]")
axes.legend()
figure

# %%

last = float(abs(load[2 * len(load) // 3 :]).mean())
print(f"mean of the last third: {last:.1f} kN/m, {last / prandtl:.2f} times Prandtl's load")
