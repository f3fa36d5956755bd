"""Operations of a time step: its kernels, called at once or shared out among the threads that a run has."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmfw.errors import Diverged, SimulationError
from mpmfw.kernels import particle_grid as kernels
from mpmfw.state.clock import Clock
from mpmfw.state.fields import FloatArray
from mpmfw.state.pairs import update_pairs
from mpmfw.state.structs import Body, Grid, OutsideGrid, Particles, State, Stencil
from mpmfw.state.windows import fit_windows
from mpmfw.step.transfer import Transfer


def interpolate(state: State, hook: Any, clock: Clock) -> Stencil:
    """φ_ip and ∇φ_ip, and N_i(x_s) where surfaces are tracked; windows are laid anew when a body leaves its
    own.

    Raises
    ------
    SimulationError
        A point is outside the background grid.
    """
    try:
        return _tables(state, hook, clock)
    except OutsideGrid:
        threads, reach = state.particles.threads, hook.particle_reach(particles=state.particles)
        fit_windows(state.grid, state.particles, reach, state.surface)
        update_pairs(state, hook)
        if threads is not None:
            threads.share_anew()
    try:
        return _tables(state, hook, clock)
    except OutsideGrid as error:
        raise _left_the_grid(state, error) from None


def _tables(state: State, hook: Any, clock: Clock) -> Stencil:
    """Fill the tables of the material points and of the surface nodes; return the points'."""
    particles, grid, surface = state.particles, state.grid, state.surface
    phi: Stencil = hook.interpolate(particles=particles, grid=grid)
    if particles.threads is not None:
        particles.threads.share_nodes(phi.row, phi.nodes)
    if surface is not None:
        clock(surface.stage)
        position, first = surface.position, surface.first
        try:
            surface.stencil = hook.interpolate_surface(position=position, first=first, grid=grid)
        except OutsideGrid as error:
            raise OutsideGrid(error.index, surface=True) from None
    return phi


def _left_the_grid(state: State, error: OutsideGrid) -> SimulationError:
    """Name the body, the index within it, the position and the time."""
    if error.surface and state.surface is not None:
        body = state.bodies[int(state.surface.body[error.index])]
        first, position = int(state.surface.body_first[body.index]), state.surface.position[error.index]
        what = "a surface node left the grid"
    else:
        body = _body_of(state, error.index)
        first, position = body.particles.start, state.particles.position[error.index]
        what = "a material point left the grid"
    return SimulationError(
        what,
        body=body.name,
        index=error.index - first,
        position=position.tolist(),
        time=state.time,
        advice="a larger grid (grid.lower, grid.upper), or an earlier time.end; if the position is far off "
        "or nan, a smaller time.safety",
    )


def _body_of(state: State, point: int) -> Body:
    """Return the body that a material point belongs to."""
    return next(body for body in state.bodies if body.particles.start <= point < body.particles.stop)


def _over_points(p: Particles, kernel: Callable[..., Any], *given: Any) -> Any:
    """Run a kernel in which no point needs another; threads share out the points."""
    return kernel(p, *given) if p.threads is None else p.threads.over_points(kernel, p, *given)


def _over_nodes(p: Particles, kernel: Callable[..., Any], *given: Any) -> None:
    """Run a kernel in which points add to nodes; threads share out the nodes."""
    if p.threads is None:
        kernel(p, *given)
    else:
        p.threads.over_nodes(kernel, p, *given)


def project(p: Particles, phi: Stencil, g: Grid) -> None:
    """m_i, (m v)_i and the velocity v_i⁰ that increments are counted from; forces become zero."""
    g.reset()
    _apply_moment(p, phi, g, p.position)
    _over_nodes(p, kernels.project, p.position, p.affine, phi, g, g.mass, g.spacing)
    kernels.velocity_of_momentum(g.mass, g.momentum, g.start_velocity, g.spacing)


def add_internal_force(p: Particles, phi: Stencil, g: Grid) -> None:
    """f_i −= Σ V σ·∇φ."""
    _over_nodes(p, kernels.add_internal_force, p.thickness, phi, g, g.spacing)


def project_again(p: Particles, phi: Stencil, g: Grid, position: FloatArray) -> None:
    """(m v)_i = Σ φ m (v + C (x_i − x)) with the new v and C, and the ``position`` that φ belongs to
    (MUSL)."""
    _apply_moment(p, phi, g, position)
    g.momentum.fill(0.0)
    _over_nodes(p, kernels.project, position, p.affine, phi, g, None, g.spacing)


def _apply_moment(p: Particles, phi: Stencil, g: Grid, position: FloatArray) -> None:
    """C_p = B_p D_p⁻¹ at the present stencil, for a transfer that stores the moment B_p."""
    if p.moment is not None and p.affine is not None:
        _over_points(p, kernels.affine_from_moment, position, p.moment, p.affine, phi, g, g.spacing)


def gather(p: Particles, phi: Stencil, g: Grid, transfer: Transfer, dt: float) -> None:
    """v_p, x_p, L_p and the affine field from the grid's final velocity; the field is not transported yet."""
    kind = transfer.affine
    affine = p.moment if kind == "moment" else p.affine if kind == "least_squares" else None
    _over_points(p, kernels.gather, affine, phi, g, kind == "least_squares", transfer.flip, dt, g.spacing)
    if kind == "gradient" and p.affine is not None:
        p.affine[...] = p.velocity_gradient


def gather_velocity_gradient(p: Particles, phi: Stencil, g: Grid) -> None:
    """L_p = Σ v_i ∇φᵀ of the grid's velocity now."""
    _over_points(p, kernels.gather_velocity_gradient, phi, g, g.spacing)


def transport_affine(p: Particles, transfer: Transfer, g: Grid, dt: float) -> None:
    """C ← C (1 + Δt C)⁻¹, for a transfer whose affine field is transported."""
    if transfer.transported and p.affine is not None:
        _over_points(p, kernels.transport_affine, p.affine, dt, g.spacing)


def update_deformation(state: State, dt: float) -> None:
    """F ← (1 + Δt L) F, V = det(F) V_0.

    Raises
    ------
    Diverged
        det F is not positive, or not a number.
    """
    p = state.particles
    bad = _over_points(p, kernels.update_deformation, dt, state.grid.spacing)
    if bad >= 0:
        body = _body_of(state, bad)
        jacobian = p.volume[bad] / p.initial_volume[bad]
        what = (
            "a value became NaN"
            if jacobian != jacobian
            else f"a material point inverted (det F = {jacobian:.3g})"
        )
        raise Diverged(
            what,
            body=body.name,
            index=bad - body.particles.start,
            position=p.position[bad].tolist(),
            time=state.time,
        )
