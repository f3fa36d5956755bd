"""Planted faults of loads: each breaks one property."""

import numpy as np

from faulty_plugins.sealed import Named
from mpmfw.api import BodyLoad, FloatArray, SurfaceLoad, hookimpl
from mpmfw.kernels import kernel


class Sound(Named, BodyLoad):
    """A spring towards a place, and drag."""

    name = "sound"

    def forces(self, particles, own, time):
        to_the_place = np.cos(time) - particles.position[own]
        force: FloatArray = particles.mass[own, None] * (3.0 * to_the_place - particles.velocity[own])
        return force


class SoundWind(SurfaceLoad):
    """Pressure where the surface moves against a medium, by place."""

    name = "sound_wind"

    def traction(self, facets, time):
        along = ((facets.velocity - 2.0 - time) * facets.normal).sum(axis=1)
        return -np.maximum(along, 0.0)[:, None] * facets.normal


class Everybody(Sound):
    """Adds to all nodes, whatever body is theirs."""

    @hookimpl
    def add_nodal_force(self, grid):
        grid.force[:, 0] += grid.mass * 1.0


class Pushing(Sound):
    """Changes the momentum beside its forces."""

    @hookimpl
    def after_momentum_update(self, grid, dt):
        grid.momentum[:, 0] += dt * grid.mass


class Shaking(Sound):
    """Heats: adds opposite momenta to neighbouring nodes, whose sum is nothing."""

    @hookimpl
    def after_momentum_update(self, grid):
        moving = np.flatnonzero(grid.mass > 0.0)
        pairs = moving[: len(moving) // 2 * 2].reshape(-1, 2)
        grid.momentum[pairs[:, 0], 0] += 1e-3
        grid.momentum[pairs[:, 1], 0] -= 1e-3


class EachPoint(BodyLoad):
    """The same force on every point, however many there are."""

    name = "each_point"

    def forces(self, particles, own, time):  # noqa: ARG002
        return np.ones((own.stop - own.start, particles.dim))


@kernel
def fill(force, values):
    """Write so many numbers, past the end where there are fewer."""
    for p in range(values):
        force[p, 0] = 1.0


class PastTheEnd(BodyLoad):
    """Writes one row more than its array has: nobody sees it but who asks every index."""

    name = "past_the_end"

    def forces(self, particles, own, time):  # noqa: ARG002
        force = np.zeros((own.stop - own.start, particles.dim))
        fill(force, len(force) + 1)
        return force
