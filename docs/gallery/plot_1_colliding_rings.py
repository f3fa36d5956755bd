"""
Colliding rings: force and impulse against finite elements
==========================================================

Two rubber rings meet at 60 m/s ([H17], section 4.2). The reference is a converged finite-element solution
that ships with mpmfw. Cells and particles are twice as coarse as in the shipped scene."""

import numpy as np

import mpmfw
from mpmfw import plots
from mpmfw.results.analysis import impulse

scene = mpmfw.load_scene("colliding-rings", set={"grid.cell_size": "4 mm", "output.particles": False})
best = "bardenhagen(criterion=position, normal=master)"
runs = mpmfw.compare(scene, contact=["bardenhagen", best, "penalty"], shape=["cpdi"])
runs["status"].to_series()

# %% A contact force oscillates in every explicit method, the finite elements included; averaged over 100 µs
# it can be compared, and its integral, the impulse, is the robust measure. Classical contact in its plain
# form begins too early: the rings share grid nodes before they touch. With a criterion of position it begins
# when they do.

figure = plots.contact_force(runs)
figure

# %% The impulse at the end, per metre of thickness, is what the rings' momentum changed by. The force in a
# file is the mean over its output interval, so that the sum below is exact: it equals the change of momentum
# to rounding.

time = runs["time"].values
force = runs["contact_force"].sel(pair="left-right", axis="x", shape="cpdi")
momentum = runs["linear_momentum"].sel(body="left", axis="x", shape="cpdi")
for contact in runs["contact"].values:
    given = impulse(time, force.sel(contact=contact).values)[-1]
    changed = float(momentum.sel(contact=contact)[-1] - momentum.sel(contact=contact)[0])
    print(f"{contact:46s} impulse {given:8.3f} N s/m, momentum changed by {changed:8.3f} N s/m")
    assert np.isclose(given, changed, rtol=1e-6)

# %%
# Energy
# ------
# Kinetic energy turns into strain energy and back; the rest is lost between points and grid.

total = (runs["kinetic_energy"] + runs["strain_energy"]).sum("body").sel(shape="cpdi")
(total / total.isel(time=0)).isel(time=-1).to_series()
