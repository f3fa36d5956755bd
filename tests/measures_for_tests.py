"""Measures on a simulation, written independently of the series that runs record; and a known torque."""

from typing import Any

import numpy as np

from mpmfw.api import hookimpl
from mpmfw.step.schemes import interpolate, project


def cross(a, b):
    """a × b, (n,) in 2D and (n, 3) in 3D."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] if a.shape[1] == 2 else np.cross(a, b)


def relative(particles):
    """Positions and velocities relative to those of the centre of mass."""
    share = particles.mass / particles.mass.sum()
    x, v = particles.position, particles.velocity
    return x - share @ x, v - share @ v


def momentum(sim):
    """Linear momentum Σ m v of all material points."""
    return np.asarray(sim.state.particles.mass @ sim.state.particles.velocity)


def angular_momentum(sim):
    """Σ m (x − c) × (v − v_c) of all material points."""
    r, w = relative(sim.state.particles)
    return sim.state.particles.mass @ cross(r, w)


def angular_velocity(sim):
    """ω of L = I ω with the inertia of the points."""
    r, _ = relative(sim.state.particles)
    second = np.einsum("n,ni,nj->ij", sim.state.particles.mass, r, r)
    if r.shape[1] == 2:
        return angular_momentum(sim) / np.trace(second)
    return np.linalg.solve(np.trace(second) * np.eye(3) - second, angular_momentum(sim))


class Torque:
    """Nodal forces Σ_p φ_ip m_p a × (x_p − c), whose torque is known from the points alone: Σ m r × (a × r).

    In 2D the points within ``inner`` of the centre are left out, so that the body shears as well as turns.
    """

    name = "torque"

    def __init__(self, acceleration, inner=0.0):
        self.acceleration, self.inner = np.asarray(acceleration, dtype=float), inner
        self.impulse: Any = 0.0

    @hookimpl
    def add_nodal_force(self, grid, state, phi, dt):
        """Add the forces, and the torque's impulse to the record."""
        p = state.particles
        r, _ = relative(p)
        if p.dim == 2:
            outer = (r**2).sum(axis=1) >= self.inner**2
            a = self.acceleration * np.stack([-r[:, 1], r[:, 0]], axis=1) * outer[:, None]
            a -= p.mass @ a / p.mass.sum()
        else:
            a = np.cross(self.acceleration, r)
        self.impulse = self.impulse + dt * (p.mass @ cross(r, a))
        point = np.repeat(np.arange(p.count), np.diff(phi.row))
        np.add.at(grid.force, phi.nodes, phi.weight[:, None] * (p.mass[:, None] * a)[point])


def turn_under(sim, torque, end):
    """Impulses of the torque and angular velocities after every step until ``end`` [s]."""
    sim.start()
    rows = []
    with sim.extra_plugin(torque):
        while sim.state.time < end:
            sim.step(sim.stable_step())
            rows.append((torque.impulse, angular_velocity(sim)))
    impulse, spin = zip(*rows, strict=True)
    return np.array(impulse), np.array(spin)


def detect(simulation):
    """Detect the contacts where the bodies are now, without a step."""
    state = simulation.state
    phi = interpolate(state, simulation.hook, simulation.clock)
    project(state.particles, phi, state.grid)
    simulation.hook.detect(grid=state.grid, phi=phi, particles=state.particles)
