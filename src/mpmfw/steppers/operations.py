"""The lines of a time step: each calls one kernel with the arrays that it needs."""

from __future__ import annotations

from typing import Any

from mpmfw.clock import Clock
from mpmfw.errors import SimulationError
from mpmfw.fields import FloatArray
from mpmfw.kernels import gather as from_grid
from mpmfw.kernels import nodal
from mpmfw.kernels import projection as to_grid
from mpmfw.pairs import list_near
from mpmfw.state import Grid, OutsideGrid, Particles, State, Stencil
from mpmfw.transfer import Transfer
from mpmfw.windows import lay_windows


def interpolate(state: State, hook: Any, clock: Clock) -> Stencil:
    """φ_ip and ∇φ_ip, and N_i(x_s) where surfaces are tracked; windows are laid anew when a body leaves its
    own.

    Raises
    ------
    SimulationError
        A point is outside the background grid.
    """
    particles, grid, surface = state.particles, state.grid, state.surface
    try:
        phi: Stencil = hook.interpolate(particles=particles, grid=grid)
        if surface is not None:
            clock(surface.stage)
            surface.stencil = hook.interpolate_surface(
                position=surface.position, first=surface.first, grid=grid
            )
    except OutsideGrid:
        return _interpolate_anew(state, hook)
    return phi


def _interpolate_anew(state: State, hook: Any) -> Stencil:
    """The same after the windows were laid round the bodies as they are now."""
    particles, grid, surface = state.particles, state.grid, state.surface
    lay_windows(grid, particles, hook.particle_reach(particles=particles), surface)
    list_near(state, hook)
    try:
        phi: Stencil = hook.interpolate(particles=particles, grid=grid)
    except OutsideGrid as error:
        raise _left_the_grid(state, error) from None
    if surface is not None:
        try:
            surface.stencil = hook.interpolate_surface(
                position=surface.position, first=surface.first, grid=grid
            )
        except OutsideGrid as error:
            raise _left_the_grid(state, OutsideGrid(error.index, surface=True)) from None
    return phi


def _left_the_grid(state: State, error: OutsideGrid) -> SimulationError:
    """Name the body, the index within it, the position and the time."""
    if error.surface and state.surface is not None:
        body = state.bodies[int(state.surface.body[error.index])]
        first, position = int(state.surface.body_first[body.index]), state.surface.position[error.index]
        what = "a surface node left the grid"
    else:
        body = next(b for b in state.bodies if b.particles.start <= error.index < b.particles.stop)
        first, position = body.particles.start, state.particles.position[error.index]
        what = "a material point left the grid"
    return SimulationError(
        what,
        body=body.name,
        index=error.index - first,
        position=position.tolist(),
        time=state.time,
        advice="a larger grid (grid.lower, grid.upper), or an earlier time.end; if the position is far off or nan, "
        "a smaller time.safety",
    )


def project_mass_momentum(p: Particles, phi: Stencil, g: Grid) -> None:
    """m_i and (m v)_i, and the velocity v_i⁰ that increments are counted from."""
    to_grid.project_mass_momentum(
        phi.row,
        phi.nodes,
        phi.weight,
        p.mass,
        p.velocity,
        p.position,
        p.affine,
        g.position,
        g.mass,
        g.momentum,
        g.spacing,
    )
    nodal.velocity_of_momentum(g.mass, g.momentum, g.start_velocity, g.spacing)


def apply_moment(p: Particles, phi: Stencil, g: Grid, position: FloatArray | None = None) -> None:
    """C_p = B_p D_p⁻¹ at the present stencil, for a transfer that stores the moment B_p."""
    if p.moment is not None and p.affine is not None:
        x = p.position if position is None else position
        to_grid.affine_from_moment(
            phi.row, phi.nodes, phi.weight, x, p.moment, g.position, p.affine, g.spacing
        )


def add_internal_force(p: Particles, phi: Stencil, g: Grid) -> None:
    """f_i −= Σ V σ·∇φ, V with the thickness."""
    volume = p.through(p.volume)
    to_grid.add_internal_force(phi.row, phi.nodes, phi.gradient, volume, p.stress, g.force, g.spacing)


def integrate_momentum(g: Grid, dt: float) -> None:
    """(m v)_i += Δt f_i."""
    nodal.integrate_momentum(g.mass, g.momentum, g.force, dt, g.spacing)


def finish_velocity(g: Grid) -> None:
    """v_i = (m v)_i / m_i."""
    nodal.velocity_of_momentum(g.mass, g.momentum, g.velocity, g.spacing)


def gather_velocity_position(p: Particles, phi: Stencil, g: Grid, transfer: Transfer, dt: float) -> None:
    """v_p, x_p, L_p and the affine field, from the grid's final velocity."""
    kind = transfer.affine
    affine = p.moment if kind == "moment" else p.affine if kind == "least_squares" else None
    from_grid.gather(
        phi.row,
        phi.nodes,
        phi.weight,
        phi.gradient,
        g.position,
        g.velocity,
        g.start_velocity,
        p.velocity,
        p.position,
        p.velocity_gradient,
        affine,
        kind == "least_squares",
        transfer.flip,
        dt,
        g.spacing,
    )
    if kind == "gradient" and p.affine is not None:
        p.affine[...] = p.velocity_gradient


def transport_affine(p: Particles, g: Grid, transfer: Transfer, dt: float) -> None:
    """C ← C (1 + Δt C)⁻¹, for a transfer whose affine field is carried along."""
    if transfer.transported and p.affine is not None:
        from_grid.transport_affine(p.affine, dt, g.spacing)


def gather_velocity_gradient(p: Particles, phi: Stencil, g: Grid) -> None:
    """L_p from the grid's present ``velocity``."""
    from_grid.gather_velocity_gradient(
        phi.row, phi.nodes, phi.gradient, g.velocity, p.velocity_gradient, g.spacing
    )


def update_deformation(state: State, dt: float) -> None:
    """F ← (1 + Δt L) F, V = det(F) V_0.

    Raises
    ------
    SimulationError
        det F is not positive, or not a number.
    """
    p, g = state.particles, state.grid
    bad = from_grid.update_deformation(
        p.velocity_gradient, p.deformation_gradient, p.initial_volume, p.volume, dt, g.spacing
    )
    if bad >= 0:
        body = next(b for b in state.bodies if b.particles.start <= bad < b.particles.stop)
        jacobian = p.volume[bad] / p.initial_volume[bad]
        what = (
            "a value became NaN"
            if jacobian != jacobian
            else f"a material point inverted (det F = {jacobian:.3g})"
        )
        raise SimulationError(
            what,
            body=body.name,
            index=bad - body.particles.start,
            position=p.position[bad].tolist(),
            time=state.time,
            advice="a smaller time.safety; shape 'cpdi' with scheme 'usl'; a softer contact",
        )


def project_momentum_again(p: Particles, phi: Stencil, g: Grid, position: FloatArray) -> None:
    """(m v)_i = Σ φ m (v + C (x_i − x)) with the new v and C, and the ``position`` that φ belongs to
    (MUSL)."""
    apply_moment(p, phi, g, position)
    g.momentum.fill(0.0)
    to_grid.project_momentum(
        phi.row,
        phi.nodes,
        phi.weight,
        p.mass,
        p.velocity,
        position,
        p.affine,
        g.position,
        g.momentum,
        g.spacing,
    )
