"""A torque that is known from the material points alone, and the inertia with which a body answers it."""

import math

import numpy as np
from point_forces import PointForces

from mpmfw.api import FloatArray, Particles, State
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import Scene


def about_centre(particles: Particles) -> tuple[FloatArray, FloatArray]:
    """Positions [m] and velocities [m/s] of the points relative to those of the centre of mass."""
    share = particles.mass / particles.mass.sum()
    return particles.position - share @ particles.position, particles.velocity - share @ particles.velocity


def moment(particles: Particles, vectors: FloatArray, lever: FloatArray) -> float:
    """Σ m r × w."""
    return float(particles.mass @ (lever[:, 0] * vectors[:, 1] - lever[:, 1] * vectors[:, 0]))


class Torque(PointForces):
    """α e_z × r_p at the points at least ``inner`` [m] from the centre of mass, α = 20 rad/s².

    Without the points within ``inner`` the body shears as well as turns.
    """

    def __init__(self, inner: float) -> None:
        self.inner, self.impulse = inner, 0.0

    def acceleration(self, state: State, dt: float) -> FloatArray:
        """Add Σ m r × a over the step to the impulse [kg m²/s/m] as well."""
        p = state.particles
        lever, _ = about_centre(p)
        a = 20.0 * np.stack([-lever[:, 1], lever[:, 0]], axis=1)
        a *= ((lever**2).sum(axis=1) >= self.inner**2)[:, None]
        a -= p.mass @ a / p.mass.sum()
        self.impulse += dt * moment(p, a, lever)
        return a


def inertia(scene: Scene) -> dict[str, float]:
    """Relative error of the inertia under a torque on the whole ``disc``, and on its ``rim`` alone."""
    return {name: effective_inertia(scene, inner) - 1.0 for name, inner in (("disc", 0.0), ("rim", 0.7))}


def effective_inertia(scene: Scene, inner: float, end: float = 0.1) -> float:
    """I of ∫ τ dt = I ω, least squares over all steps until ``end`` [s], over m R² / 2.

    ω = Σ m r × v / Σ m |r|² over the points: how fast the material turns, whatever inertia the grid gives it.
    """
    sim, torque, rows = Simulation(scene), Torque(inner), []
    sim.start()
    p = sim.state.particles
    with sim.extra_plugin(torque):
        while sim.state.time < end:
            sim.step(sim.stable_step())
            lever, velocity = about_centre(p)
            rows.append((torque.impulse, moment(p, velocity, lever) / float(p.mass @ (lever**2).sum(axis=1))))
    impulse, spin = np.array(rows).T
    disc = 0.5 * math.pi * 1000.0  # ρ π R⁴ / 2 with R = 1 m, of the scene
    return float(impulse @ impulse / (impulse @ spin) / disc)
