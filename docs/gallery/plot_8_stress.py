"""
Stress in a run
===============

Two blocks between frictionless walls, pressed together by a platen: the vertical stress is the pressure,
everywhere. What contacts make of it, material point by material point. Classical contact runs twice: with the
mean of both bodies' normals, which is its default, and with the normal given, its strongest form where the
interface is known."""

import matplotlib.pyplot as plt

import mpmfw
from mpmfw import plots
from mpmfw.plots.style import dress, new_figure

plt.style.use("mpmfw.plots.journal")

contacts = ["bardenhagen", "bardenhagen(direction=[0.0, 1.0], normal=specified)", "penalty"]
trees = {
    contact: mpmfw.run("contact-stress", contact=contact, set={"output.particles": True})
    for contact in contacts
}
trees["penalty"]["particles/lower"].to_dataset()

# %% The pressure is 0.2 MPa; the colour scale ends 20 % below and above it, and its pointed ends say that
# there are values beyond: yellow is anything from 20 % too little on, violet anything from 20 % too much.
# With averaged normals the blocks' corners, where a normal turns towards the walls, carry too little, and
# their neighbours too much; the given normal knows no corners.

pressure = 2e5
figure = plots.side_by_side(trees, "stress_yy", limits=(-1.2 * pressure, -0.8 * pressure))
figure

# %%
# How far the stress departs from the pressure within a cell of the interface. ``mpmfw.field`` has
# the material points of both bodies with their coordinates, as an array of xarray:

for contact, tree in trees.items():
    stress = mpmfw.field(tree, "stress_yy")
    near = stress.where(abs(stress["y"] - 1.037) < 0.1, drop=True)
    print(f"{contact:54s} largest {float(100 * abs(near / -pressure - 1).max()):5.2f} %")
near

# %% So far the blocks had settled under the pressure. Without that it acts at once, and they swing about
# their rest, at a period of four times the height over the wave speed: 58 ms. ``mpmfw.gap`` is the distance
# of the surfaces, negative where they penetrate; springs need a penetration to carry a pressure, and here up
# to twice that at rest. When the blocks are at their tallest again, the surfaces part for a moment: they
# cannot pull.

changes = {"settle": None, "time.end": 0.12, "time.output_interval": 5e-4}
swinging = mpmfw.run("contact-stress", contact="penalty", set=changes)
gap = mpmfw.gap(swinging)
figure = new_figure(1, 1)
axes = figure.subplots()
axes.plot(1e3 * gap["time"], 1e3 * gap, label="swinging")
at_rest = float(mpmfw.gap(trees["penalty"])[-1])
axes.axhline(1e3 * at_rest, color="black", linewidth=0.8, label="settled")
dress(axes, "time [ms]", "gap between the blocks [mm]")
axes.legend()
print(f"least gap {1e3 * float(gap.min()):.2f} mm")
figure

# %%
# ``mpmfw.history`` has any series of a run, of one body and along one axis where asked for:

height = mpmfw.history(swinging, "centre_of_mass", body="upper", axis="y")
figure = new_figure(1, 1)
axes = figure.subplots()
axes.plot(1e3 * height["time"], 1e3 * (height - height[0]))
dress(axes, "time [ms]", "displacement of the upper block [mm]")
figure
