"""
Taylor's bar: plastic impact of a body of revolution
====================================================

A copper bar, 32.4 mm long and 6.4 mm thick, hits a smooth rigid wall at 227 m/s. Plastic flow spreads its
foot and shortens it. The bar is a rectangle that revolves around the axis x = 0."""

import matplotlib.pyplot as plt
import numpy as np

import mpmfw
from mpmfw.plots.style import dress, new_figure

plt.style.use("mpmfw.plots.journal")

tree = mpmfw.run("taylor-bar")

# %%
# The bar after 80 µs, in the half-plane of radius and height:

figure = mpmfw.plots.field(tree, "plastic_strain")
figure

# %%
# Codes agree on a final length of about 21.4 mm and a foot of about 7 mm
# (``mpmfw validate axisymmetry`` has the gates). The outermost material points lie half a domain inside the
# surface.

points = mpmfw.field(tree, "plastic_strain", body="bar")
print(f"highest point {1e3 * float(points['y'].max()):.2f} mm")
print(f"outermost point {1e3 * float(points['x'].max()):.2f} mm")

# %%
# Where the energy goes
# ---------------------

series = tree["series"].to_dataset()
time = 1e6 * series["time"]
figure = new_figure(1, 1)
axes = figure.subplots()
for name in ("kinetic_energy", "strain_energy"):
    axes.plot(time, series[name].sum("body"), label=name.replace("_", " "))
axes.plot(time, series["total_energy"].sum("body"), color="black", linewidth=0.8, label="sum")
dress(axes, "time [µs]", "energy [J]")
axes.legend()
figure

# %%
# What the sum loses is plastic work, which ends as heat.

lost = 1.0 - float(series["total_energy"].sum("body")[-1] / series["total_energy"].sum("body")[0])
print(f"{100 * lost:.0f} % of the kinetic energy")
assert np.isclose(lost, 1.0, atol=0.1)
