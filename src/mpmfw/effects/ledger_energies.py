"""Energies that the ledger adds up: of the motion on the grid and on the material points, of impulses."""

from __future__ import annotations

import numpy as np

from mpmfw.kernels import kernel
from mpmfw.kernels.body_sums import sum_affine_energy
from mpmfw.kernels.types import Floats
from mpmfw.state.structs import State


@kernel
def grid_energy(mass: Floats, momentum: Floats) -> float:
    """Σ |(m v)_i|² / (2 m_i) over nodes with mass."""
    total = 0.0
    for i in range(len(mass)):
        if mass[i] > 0.0:
            square = 0.0
            for d in range(momentum.shape[1]):
                square += momentum[i, d] * momentum[i, d]
            total += 0.5 * square / mass[i]
    return total


@kernel
def add_change(momentum: Floats, last: Floats, impulse: Floats) -> bool:
    """I_i += m v − ``last``, the change of the momenta since the last look, which is now; whether there is
    one.
    """
    changed = False
    for i in range(len(momentum)):
        for d in range(momentum.shape[1]):
            if momentum[i, d] != last[i, d]:
                impulse[i, d] += momentum[i, d] - last[i, d]
                last[i, d] = momentum[i, d]
                changed = True
    return changed


@kernel
def impulse_work(impulse: Floats, mass: Floats, start_velocity: Floats, momentum: Floats) -> float:
    """Σ I_i·(v_i⁰ + v_i¹) / 2 over nodes with mass; ``momentum`` is m v¹."""
    total = 0.0
    for i in range(len(mass)):
        if mass[i] > 0.0:
            for d in range(momentum.shape[1]):
                total += 0.5 * impulse[i, d] * (start_velocity[i, d] + momentum[i, d] / mass[i])
    return total


@kernel
def kinetic_energy(mass: Floats, velocity: Floats) -> float:
    """Σ m v² / 2 over material points."""
    total = 0.0
    for p in range(len(mass)):
        square = 0.0
        for d in range(velocity.shape[1]):
            square += velocity[p, d] * velocity[p, d]
        total += 0.5 * mass[p] * square
    return total


def motion_energy(state: State) -> float:
    """Return the kinetic and affine energy of the material points [J/m]."""
    p, affine = state.particles, np.zeros(1)
    if p.affine is not None:
        sum_affine_energy(np.array([0, p.count]), p, p.affine, affine, state.grid.spacing)
    return float(kinetic_energy(p.mass, p.velocity) + affine[0])
