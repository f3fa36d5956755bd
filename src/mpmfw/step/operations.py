"""The lines of a time step: each calls one kernel with the arrays that it needs.

A line is marked by what several threads share out in it, where a run has them: the points, or the nodes.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from mpmfw.errors import Diverged, SimulationError
from mpmfw.kernels import gather as from_grid
from mpmfw.kernels import nodal
from mpmfw.kernels import projection as to_grid
from mpmfw.state.clock import Clock
from mpmfw.state.fields import FloatArray
from mpmfw.state.pairs import list_near
from mpmfw.state.structs import Grid, OutsideGrid, Particles, State, Stencil
from mpmfw.state.windows import lay_windows
from mpmfw.step.transfer import Transfer

if TYPE_CHECKING:
    from mpmfw.kernels.table import NodeRange

Line = TypeVar("Line", bound=Callable[..., Any])


def over_points(line: Line) -> Line:
    """Mark a line in which no point asks another; it returns None, or the first point that failed, −1 if none did."""

    @functools.wraps(line)
    def shared(particles: Particles, *arguments: Any) -> Any:
        threads = particles.threads
        if threads is None:
            return line(particles, *arguments)
        return threads.over_points(line, particles, *arguments)

    return shared  # type: ignore[return-value]


def over_nodes(line: Line) -> Line:
    """Mark a line in which points add to nodes, to ``own_nodes`` alone if they are given."""

    @functools.wraps(line)
    def shared(particles: Particles, *arguments: Any) -> None:
        threads = particles.threads
        if threads is None:
            line(particles, *arguments)
        else:
            threads.over_nodes(line, particles, *arguments)

    return shared  # type: ignore[return-value]


def interpolate(state: State, hook: Any, clock: Clock) -> Stencil:
    """φ_ip and ∇φ_ip, and N_i(x_s) where surfaces are tracked; windows are laid anew when a body leaves its
    own.

    Raises
    ------
    SimulationError
        A point is outside the background grid.
    """
    grid, surface = state.grid, state.surface
    try:
        phi = _table(state, hook)
        if surface is not None:
            clock(surface.stage)
            surface.stencil = hook.interpolate_surface(
                position=surface.position, first=surface.first, grid=grid
            )
    except OutsideGrid:
        return _interpolate_anew(state, hook)
    return phi


def _table(state: State, hook: Any) -> Stencil:
    """φ_ip and ∇φ_ip of the material points."""
    particles = state.particles
    phi: Stencil = hook.interpolate(particles=particles, grid=state.grid)
    if particles.threads is not None:
        particles.threads.share_nodes(phi)
    return phi


def _interpolate_anew(state: State, hook: Any) -> Stencil:
    """The same after the windows were laid round the bodies as they are now."""
    particles, grid, surface = state.particles, state.grid, state.surface
    lay_windows(grid, particles, hook.particle_reach(particles=particles), surface)
    list_near(state, hook)
    if particles.threads is not None:
        particles.threads.share_anew()
    try:
        phi = _table(state, hook)
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


@over_nodes
def _project_mass_momentum(p: Particles, phi: Stencil, g: Grid, own_nodes: NodeRange | None = None) -> None:
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
        own_nodes,
    )


def project_mass_momentum(p: Particles, phi: Stencil, g: Grid) -> None:
    """m_i and (m v)_i, and the velocity v_i⁰ that increments are counted from."""
    _project_mass_momentum(p, phi, g)
    nodal.velocity_of_momentum(g.mass, g.momentum, g.start_velocity, g.spacing)


@over_points
def _apply_moment(p: Particles, phi: Stencil, g: Grid, position: FloatArray) -> None:
    assert p.moment is not None
    assert p.affine is not None
    to_grid.affine_from_moment(
        phi.row, phi.nodes, phi.weight, position, p.moment, g.position, p.affine, g.spacing
    )


def apply_moment(p: Particles, phi: Stencil, g: Grid, position: FloatArray | None = None) -> None:
    """C_p = B_p D_p⁻¹ at the present stencil, for a transfer that stores the moment B_p."""
    if p.moment is not None and p.affine is not None:
        _apply_moment(p, phi, g, p.position if position is None else position)


@over_nodes
def add_internal_force(p: Particles, phi: Stencil, g: Grid, own_nodes: NodeRange | None = None) -> None:
    """f_i −= Σ V σ·∇φ, V with the thickness."""
    volume = p.through(p.volume)
    to_grid.add_internal_force(
        phi.row, phi.nodes, phi.gradient, volume, p.stress, g.force, g.spacing, own_nodes
    )


def integrate_momentum(g: Grid, dt: float) -> None:
    """(m v)_i += Δt f_i."""
    nodal.integrate_momentum(g.mass, g.momentum, g.force, dt, g.spacing)


def finish_velocity(g: Grid) -> None:
    """v_i = (m v)_i / m_i."""
    nodal.velocity_of_momentum(g.mass, g.momentum, g.velocity, g.spacing)


def _gather_velocity_position(p: Particles, phi: Stencil, g: Grid, transfer: Transfer, dt: float) -> None:
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


def _transport_affine(p: Particles, g: Grid, dt: float) -> None:
    if p.affine is not None:
        from_grid.transport_affine(p.affine, dt, g.spacing)


@over_points
def gather_velocity_position(p: Particles, phi: Stencil, g: Grid, transfer: Transfer, dt: float) -> None:
    """v_p, x_p and L_p from the grid's final velocity, and the affine field before it is carried along."""
    _gather_velocity_position(p, phi, g, transfer, dt)


@over_points
def gather(p: Particles, phi: Stencil, g: Grid, transfer: Transfer, dt: float) -> None:
    """v_p, x_p, L_p and the affine field, from the grid's final velocity."""
    _gather_velocity_position(p, phi, g, transfer, dt)
    if transfer.transported:
        _transport_affine(p, g, dt)


_transport_shared = over_points(_transport_affine)


def transport_affine(p: Particles, g: Grid, transfer: Transfer, dt: float) -> None:
    """C ← C (1 + Δt C)⁻¹, for a transfer whose affine field is carried along."""
    if transfer.transported:
        _transport_shared(p, g, dt)


@over_points
def gather_velocity_gradient(p: Particles, phi: Stencil, g: Grid) -> None:
    """L_p from the grid's present ``velocity``."""
    from_grid.gather_velocity_gradient(
        phi.row, phi.nodes, phi.gradient, g.velocity, p.velocity_gradient, g.spacing
    )


@over_points
def _update_deformation(p: Particles, g: Grid, dt: float) -> int:
    return from_grid.update_deformation(
        p.velocity_gradient, p.deformation_gradient, p.initial_volume, p.volume, dt, g.spacing
    )


def update_deformation(state: State, dt: float) -> None:
    """F ← (1 + Δt L) F, V = det(F) V_0.

    Raises
    ------
    Diverged
        det F is not positive, or not a number.
    """
    p = state.particles
    bad = _update_deformation(p, state.grid, dt)
    if bad >= 0:
        body = next(b for b in state.bodies if b.particles.start <= bad < b.particles.stop)
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


@over_nodes
def _project_momentum(
    p: Particles, phi: Stencil, g: Grid, position: FloatArray, own_nodes: NodeRange | None = None
) -> None:
    to_grid.project_momentum(
        phi.row, phi.nodes, phi.weight, p.mass, p.velocity, position, p.affine, g.position, g.momentum, g.spacing, own_nodes
    )  # fmt: skip


def project_momentum_again(p: Particles, phi: Stencil, g: Grid, position: FloatArray) -> None:
    """(m v)_i = Σ φ m (v + C (x_i − x)) with the new v and C, and the ``position`` that φ belongs to
    (MUSL)."""
    apply_moment(p, phi, g, position)
    g.momentum.fill(0.0)
    _project_momentum(p, phi, g, position)
