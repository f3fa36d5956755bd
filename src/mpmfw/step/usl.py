"""Update stress last (USL)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmfw.kernels import integrate_momentum, velocity_of_momentum
from mpmfw.state.clock import Clock
from mpmfw.state.structs import State
from mpmfw.step.operations import (
    add_internal_force,
    gather,
    interpolate,
    project,
    transport_affine,
    update_deformation,
)
from mpmfw.step.transfer import Transfer


def step(state: State, hook: Any, transfer: Transfer, clock: Clock, length: Callable[[], float]) -> float:
    """One time step; strain and positions follow from one and the same grid velocity, which keeps rotation.

    1. φ_ip, ∇φ_ip
    2. m_i = Σ φ m,  (m v)_i = Σ φ m (v + C (x_i − x_p)), per velocity field; contacts are detected, Δt is
      chosen
    3. f_i = −Σ V σ·∇φ + f_ext + f_cont                     (eq. 12 of [H17])
    4. (m v)_i += Δt f_i, then velocity-correcting contact, inertia correction, boundary conditions
    5. v_p, x_p, C_p from the grid; surface nodes move with the same velocity
    6. F ← (1 + Δt L) F, domains, σ(F)
    """
    p, g = state.particles, state.grid

    clock("shape")
    phi = interpolate(state, hook, clock)  # 1

    clock("projection")
    project(p, phi, g)  # 2
    hook.detect(grid=g, phi=phi, particles=p)
    dt = length()
    hook.after_momentum_projection(grid=g, phi=phi, particles=p, dt=dt)

    clock("force")
    add_internal_force(p, phi, g)  # 3
    hook.add_nodal_force(grid=g, state=state, phi=phi, dt=dt)
    integrate_momentum(g.mass, g.momentum, g.force, dt, g.spacing)  # 4
    hook.after_momentum_update(grid=g, phi=phi, particles=p, dt=dt)
    hook.correct_inertia(grid=g, phi=phi, particles=p, dt=dt)
    hook.constrain_momentum(grid=g, time=state.time + dt)
    velocity_of_momentum(g.mass, g.momentum, g.velocity, g.spacing)

    clock("gather")
    gather(p, phi, g, transfer, dt)  # 5
    transport_affine(p, transfer, g, dt)
    hook.advect(grid=g, dt=dt)

    clock("material")
    update_deformation(state, dt)  # 6
    hook.update_particle_domains(particles=p, grid=g, dt=dt)
    hook.update_stress(particles=p, dt=dt)
    hook.end_step(state=state)
    return dt
