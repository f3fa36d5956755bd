"""Kernels on nodal arrays alone."""

from __future__ import annotations

from mpmfw.kernels._jit import kernel
from mpmfw.kernels.types import Floats


@kernel
def velocity_of_momentum(
    mass: Floats, momentum: Floats, velocity: Floats, spacing: tuple[float, ...]
) -> None:
    """v_i = (m v)_i / m_i where there is mass, else 0."""
    dim = len(spacing)
    for i in range(len(mass)):
        inverse = 1.0 / mass[i] if mass[i] > 0.0 else 0.0
        for d in range(dim):
            velocity[i, d] = momentum[i, d] * inverse


@kernel
def integrate_momentum(
    mass: Floats, momentum: Floats, force: Floats, dt: float, spacing: tuple[float, ...]
) -> None:
    """(m v)_i += Δt f_i; nodes without mass stay at rest."""
    dim = len(spacing)
    for i in range(len(mass)):
        if mass[i] > 0.0:
            for d in range(dim):
                momentum[i, d] += dt * force[i, d]


@kernel
def add_body_force(mass: Floats, acceleration: Floats, force: Floats, spacing: tuple[float, ...]) -> None:
    """f_i += m_i b."""
    dim = len(spacing)
    for i in range(len(mass)):
        for d in range(dim):
            force[i, d] += mass[i] * acceleration[d]
