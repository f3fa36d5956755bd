"""Runs of the product under a manufactured body force."""

import math
from pathlib import Path

import numpy as np
from manufactured import WAVE, Motion

from mpmfw.api import FloatArray, Grid, State, Stencil, hookimpl
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene

FOLDER = Path(__file__).parent


class BodyForce:
    """f_i += Σ_p φ_ip m_p b(X_p, t), with the shape functions of the step.

    ``motion`` gives b, and ``start`` is X_p (n, 2) [m].
    """

    name = "body_force"

    def __init__(self, motion: Motion, start: FloatArray) -> None:
        self.motion, self.start = motion, start

    @hookimpl
    def after_momentum_projection(self, phi: Stencil) -> None:
        """Keep this step's table of shape functions."""
        self.phi = phi

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State) -> None:
        """Add the forces of all points."""
        phi, force = self.phi, self.motion.body_force(self.start, state.time)
        force *= state.particles.mass[:, None]
        point = np.repeat(np.arange(len(force)), np.diff(phi.row))
        for axis in range(2):
            share = phi.weight * force[point, axis]
            grid.force[:, axis] += np.bincount(phi.nodes, share, minlength=len(grid.force))


def displaced(
    scene: str, motion: Motion, shape: str, cell: float, courant: float
) -> tuple[FloatArray, FloatArray]:
    """Positions (n, 2) [m] of the points at the end, and what they should be.

    Velocities of the scheme belong to half steps (a leapfrog), so that points start with the velocity of t =
    −Δt/2."""
    sim = Simulation(load_scene(FOLDER / scene, set={"grid.cell_size": cell, "shape.method": shape}))
    sim.start()
    p = sim.state.particles
    start = p.position.copy()
    steps = math.ceil(motion.end / (courant * cell / WAVE))
    step = motion.end / steps
    p.velocity[...] = motion.velocity(start, -0.5 * step)
    if p.affine is not None:
        p.affine[...] = velocity_gradient(motion, start, -0.5 * step)
    with sim.extra_plugin(BodyForce(motion, start)):
        for _ in range(steps):
            sim.step(step)
    return p.position.copy(), motion.position(start, motion.end)


def velocity_gradient(motion: Motion, start: FloatArray, time: float) -> FloatArray:
    """∂v/∂X (n, 2, 2) [1/s] by central differences; X is x but for half a step."""
    shift = 1e-5
    columns = [
        (motion.velocity(start + d, time) - motion.velocity(start - d, time)) / (2.0 * shift)
        for d in shift * np.eye(2)
    ]
    return np.stack(columns, axis=2)


def root_mean_square(difference: FloatArray) -> float:
    """√(Σ |d|² / n) [m]."""
    return float(np.sqrt((difference**2).sum(axis=1).mean()))
