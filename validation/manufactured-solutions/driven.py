"""Runs of the product under a manufactured body force."""

import math
from pathlib import Path

import numpy as np
from manufactured import WAVE, Motion
from point_forces import PointForces

from mpmfw.api import FloatArray, State
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene

FOLDER = Path(__file__).parent


class BodyForce(PointForces):
    """b(X_p, t) of a motion, at points that start at X_p (n, 2) [m]."""

    def __init__(self, motion: Motion, start: FloatArray) -> None:
        self.motion, self.start = motion, start

    def acceleration(self, state: State, dt: float) -> FloatArray:  # noqa: ARG002
        """Return b."""
        return self.motion.body_force(self.start, state.time)


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
