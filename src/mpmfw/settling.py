"""Settling to static equilibrium before time zero, by kinetic damping (Cundall 1982).

The bodies move under the loads; whenever their kinetic energy has passed a peak, all velocities are set to zero. No damping
parameter is needed, and at rest nothing of the damping is left in the stresses.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from mpmfw.errors import ResultsWarning
from mpmfw.state import State

if TYPE_CHECKING:
    from mpmfw.simulation import Simulation

#: Crossings of the scene by an elastic wave after which settling gives up, unless the scene says otherwise.
CROSSINGS = 400


def residual_force(state: State) -> float:
    """Σ |Δ(m v)_i| / Δt over the nodes: the force that is not balanced, boundary conditions included [N/m]."""
    grid = state.grid
    change = grid.mass[:, None] * (grid.velocity - grid.start_velocity)
    return float(np.linalg.norm(change, axis=1).sum()) / state.dt


def stop_motion(state: State) -> None:
    """Set velocities and affine fields to zero."""
    p = state.particles
    p.velocity.fill(0.0)
    for array in (p.affine, p.moment):
        if array is not None:
            array.fill(0.0)


def kinetic_energy(state: State) -> float:
    """Σ m v² / 2 over all material points [J/m]."""
    p = state.particles
    return 0.5 * float(p.mass @ np.einsum("nd,nd->n", p.velocity, p.velocity))


def settle(simulation: Simulation, tolerance: float, max_time: float | None) -> dict[str, float]:
    """Step until the residual force is below ``tolerance`` times the force at the first step.

    Returns
    -------
    ``settle_residual``, ``settle_steps`` and ``settle_simulated_time`` [s] for the results' file. If the limit of time is
    reached first, a warning says so and the residual tells how far it got.
    """
    state = simulation.state
    slowest = min(body.wave_speed for body in state.bodies)
    longest = max(max(np.subtract(body.upper, body.lower)) for body in state.bodies)
    limit = CROSSINGS * longest / slowest if max_time is None else max_time
    simulation.step(simulation.stable_step())
    applied = residual_force(state)
    energy, residual = kinetic_energy(state), 1.0
    while residual > tolerance and state.time < limit:
        simulation.step(simulation.stable_step())
        now = kinetic_energy(state)
        residual = residual_force(state) / applied if applied > 0.0 else 0.0
        if now < energy:
            stop_motion(state)
            now = 0.0
        energy = now
    if residual > tolerance:
        warnings.warn(
            f"settling stopped after {state.time:.3g} s with a residual force of {residual:.2g} of the applied one "
            f"(asked for: {tolerance:.2g})",
            ResultsWarning,
            stacklevel=2,
        )
    stop_motion(state)
    return {"settle_residual": residual, "settle_steps": state.steps, "settle_simulated_time": state.time}
