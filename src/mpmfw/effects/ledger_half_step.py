"""Work that forces do half a step apart from the velocity, where velocities are half a step behind positions.

With update stress last a step is a leapfrog: a force f^n at the positions x^n takes the velocity from half a step before to
half a step after, and the positions move with the latter. Over the displacement Δt v^n of a step the mean of the forces at both
of its ends does the work that springs and strain take up (Belytschko, Liu & Moran, Nonlinear finite elements, box 6.1), and the
ledger's impulse times mean velocity, which is that of the grid's kinetic energy, does not. Summed over the steps they differ by

    Σ I^n·(v0^n − v^(n−1)) / 2 − I^N·v^N / 2,      I = Δt f.

The last term is of the half step that positions are ahead. The sum is of what the transfer took from the velocity between two
steps: as the transfer loses kinetic energy, so it loses this work, and both are dissipation and no error in time. What is
left of a residual is of the step's second order, and of steps that change their length.
"""

from __future__ import annotations

import numpy as np

from mpmfw.fields import FloatArray
from mpmfw.kernels import kernel
from mpmfw.kernels.types import Floats
from mpmfw.state import Grid


@kernel
def lost_between(impulse: Floats, mass: Floats, start_velocity: Floats, last: Floats) -> float:
    """Σ I_i·(v_i⁰ − v_i) / 2 over nodes with mass, v_i ``last`` step's new velocity, NaN where there was no mass."""
    total = 0.0
    for i in range(len(mass)):
        if mass[i] > 0.0 and last[i, 0] == last[i, 0]:
            for d in range(impulse.shape[1]):
                total += 0.5 * impulse[i, d] * (start_velocity[i, d] - last[i, d])
    return total


@kernel
def half_of(impulse: Floats, velocity: Floats) -> float:
    """Σ I_i·v_i / 2 over nodes whose velocity is a number."""
    total = 0.0
    for i in range(len(impulse)):
        if velocity[i, 0] == velocity[i, 0]:
            for d in range(impulse.shape[1]):
                total += 0.5 * impulse[i, d] * velocity[i, d]
    return total


class HalfStep:
    """Both sums, of the internal forces and of contact's [J/m].

    Attributes
    ----------
    strain
        Of the internal forces, up to the positions of now; the force of now is taken for that of the step's beginning.
    contact
        Of contact's forces, up to the positions that they were found at, which are a step old.
    """

    def __init__(self) -> None:
        self.strain = self.contact = self._strain = self._contact = 0.0
        self.last: FloatArray | None = None
        self.frame = -1

    def add(self, grid: Grid, internal: FloatArray, contact: FloatArray | None) -> None:
        """A step, whose momentum is integrated; impulses are (n_nodes, dim) [N s/m]."""
        held = (grid.mass > 0.0)[:, None]
        velocity = np.where(held, grid.momentum / np.where(held, grid.mass[:, None], 1.0), np.nan)
        if self.last is not None and self.frame == grid.frame:
            self._strain += lost_between(internal, grid.mass, grid.start_velocity, self.last)
            if contact is not None:
                self.contact = self._contact - half_of(contact, self.last)
                self._contact += lost_between(contact, grid.mass, grid.start_velocity, self.last)
        self.strain = self._strain - half_of(internal, velocity)
        self.last, self.frame = velocity, grid.frame
