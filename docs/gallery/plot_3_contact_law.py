"""
Your own contact law beside the bundled ones
============================================

This law adds a thin viscous film to Coulomb's friction. Where the bodies are pressed together, the film resists
sliding with the shear stress :math:`c\\,v`. Here :math:`v` is the sliding velocity and :math:`c` the film's viscosity
over its thickness [Pa s/m].

The law acts at the grid nodes that two bodies share, as classical contact does. With :math:`m` the reduced
mass of the two nodal masses, :math:`\\Delta v` the relative velocity, :math:`n` the normal and :math:`A` the
contact area that belongs to the node,

.. math:: J_n = m\\,\\Delta v\\cdot n, \\qquad J_t = \\min(\\mu J_n + c A\\,\\Delta t\\,|\\Delta v_t|,\\; m\\,|\\Delta v_t|).

A law is a class with options, and methods for its places in the time step. Here it is, in plain NumPy.
"""  # noqa: E501

import matplotlib.pyplot as plt
import numpy as np
from pydantic import BaseModel, Field

import mpmfw
from mpmfw.api import ContactStrategy, hookimpl
from mpmfw.plots.style import Look, dress, legend_below, new_figure

plt.style.use("mpmfw.plots.journal")


class FilmOptions(BaseModel, extra="forbid", frozen=True):
    resistance: float = Field(0.0, ge=0.0, description="viscosity over thickness [Pa s/m]")


class Film(ContactStrategy):
    """Coulomb friction and a viscous film at shared grid nodes."""

    name = "film"
    Options = FilmOptions
    uses_friction = True

    @hookimpl
    def setup(self, setup):
        self.bodies, self.pairs = setup.bodies, setup.pairs

    @hookimpl
    def after_momentum_update(self, grid, phi, particles, dt):
        surface = np.zeros_like(grid.momentum)  # sum of V grad phi: the surface at a node, pointing outwards
        volume = np.repeat(particles.volume, np.diff(phi.row))
        np.add.at(surface, phi.nodes, volume[:, None] * phi.gradient)
        for pair in self.pairs:
            first, second = self.bodies[pair.first], self.bodies[pair.second]
            a, b = shared_nodes(grid, first.field, second.field)
            m_a, m_b = grid.mass[a], grid.mass[b]
            n = (first.p_wave_modulus >= second.p_wave_modulus) * surface[a]  # the stiffer body's normal
            n = n - (second.p_wave_modulus >= first.p_wave_modulus) * surface[b]
            n = n / np.maximum(np.linalg.norm(n, axis=1), 1e-300)[:, None]
            area = np.minimum((surface[a] * n).sum(1), -(surface[b] * n).sum(1)).clip(0.0)
            motion = grid.momentum[a] / m_a[:, None] - grid.momentum[b] / m_b[:, None]
            approach = (motion * n).sum(1)
            slip = motion - approach[:, None] * n
            speed = np.maximum(np.linalg.norm(slip, axis=1), 1e-300)
            mass = m_a * m_b / (m_a + m_b)
            drag = pair.friction * mass * approach + self.options.resistance * area * dt * speed
            sliding = np.minimum(drag, mass * speed) / speed
            impulse = (mass * approach)[:, None] * n + sliding[:, None] * slip
            impulse[approach <= 0.0] = 0.0  # parting bodies get no impulse
            grid.momentum[a] -= impulse
            grid.momentum[b] += impulse


def shared_nodes(grid, first, second):
    """Nodes of two velocity fields at the same places of the background grid, with mass in both."""
    found = []
    for field in (first, second):
        own = np.indices(grid.window_shape[field]).reshape(grid.dim, -1)
        place = np.ravel_multi_index(own + grid.window_lower[field][:, None], grid.nodes)
        nodes = np.arange(grid.offset[field], grid.offset[field + 1])
        found += [place[grid.mass[nodes] > 0.0], nodes[grid.mass[nodes] > 0.0]]
    _, at_first, at_second = np.intersect1d(found[0], found[2], return_indices=True)
    return found[1][at_first], found[3][at_second]


# %%
# Nothing has to be registered to try it: an object stands where a name would. Its options become its label.
#
# A block of density :math:`\rho` and height :math:`H` slides down an incline without Coulomb friction. On the
# film it approaches a terminal velocity, :math:`v = g \sin\theta\, T\,(1 - e^{-t/T})` with :math:`T = \rho H
# / c`.

resistance = 600.0
scene = mpmfw.load_scene("sliding-block", set={"contact.friction": 0.0, "time.end": 0.6})
runs = mpmfw.compare(scene, contact=["none", "penalty", Film(resistance=resistance)], shape=["cpdi"])
speed = runs["mean_velocity"].sel(body="block", axis="x", shape="cpdi")
decay = 1000.0 * 0.3 / resistance
exact = 10.0 * np.sin(np.radians(30.0)) * decay * (1.0 - np.exp(-runs["time"].values / decay))

# %%

figure = new_figure(1, 1)
axes, look = figure.subplots(), Look(runs)
for contact in runs["contact"].values:
    axes.plot(runs["time"], speed.sel(contact=contact), color=look.colours[contact], label=contact)
axes.plot(runs["time"], exact, color="black", linewidth=0.8, linestyle="--", label="its closed form")
dress(axes, "time [s]", "velocity of the block [m/s]")
lines = axes.get_legend_handles_labels()[0]
legend_below(figure, [lines[:2], lines[2:]])
figure

# %% The penalty contact has no film and slides freely; without a contact algorithm the block sticks. The film
# ends this close to its closed form:

film = speed.sel(contact=f"film(resistance={resistance})")
print(f"{100 * (float(film[-1]) / exact[-1] - 1):+.2f} % at {float(film['time'][-1])} s")

# %% ``mpmfw check`` finds one fault, ``relabelling``: where three bodies share a node, the second pair acts
# on velocities that the first has changed. The order of the bodies in the scene then changes the motion by
# 2 %. Laws on rows (``mpmfw.api.ImpulseLaw``) have a share of each node's mass for every pair instead.
#
# From here to a package that others install with pip, with a compiled kernel, tests and a name in scenes:
# :doc:`/docs/guide/write-a-contact-law`.
