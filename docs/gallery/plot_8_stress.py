"""
Stress in a run
===============

Two blocks between frictionless walls, pressed together by a platen: the vertical stress is the pressure, everywhere. What
contacts make of it, material point by material point. Classical contact runs twice: with the mean of both bodies' normals, which
is its default, and with the normal given.
"""

import numpy as np

import mpmfw
from mpmfw import plots
from mpmfw_contact.bardenhagen import Bardenhagen

contacts = {
    "bardenhagen": "bardenhagen",
    "bardenhagen, given normal": Bardenhagen(normal="specified", direction=(0.0, 1.0)),
    "penalty": "penalty",
}
trees = {
    label: mpmfw.run("contact-stress", contact=contact, set={"output.particles": True})
    for label, contact in contacts.items()
}
trees["penalty"]["particles/lower"].to_dataset()

# %%
# The pressure is 0.2 MPa; the colour scale ends 20 % below and above it. With averaged normals the blocks' corners, where a
# normal turns towards the walls, carry too little, and their neighbours too much.

pressure = 2e5
shown = {label: trees[label] for label in ("bardenhagen", "penalty")}
figure = plots.side_by_side(shown, "stress_yy", limits=(-1.2 * pressure, -0.8 * pressure))
figure

# %%
# How far the stress departs from the pressure within a cell of the interface, with the normal given as well:

for contact, tree in trees.items():
    near = []
    for body in ("lower", "upper"):
        points = tree[f"particles/{body}"].isel(time=-1)
        inside = np.abs(points["position"].values[:, 1] - 1.037) < 0.1
        near.append(-points["stress"].values[inside, 1, 1] / pressure - 1.0)
    print(f"{contact:26s} largest {100 * np.abs(np.concatenate(near)).max():5.2f} %")
