"""Time steps: one function for each scheme, and the operations that they are made of."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmfw.errors import Diverged, OutsideGrid
from mpmfw.kernels import integrate_momentum, motion, particle_grid, products, velocity_of_momentum
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Grid, Particles, State, Stencil
from mpmfw.state.windows import fit_windows
from mpmfw.step.timestep import Clock
from mpmfw.step.transfer import Transfer

Length = Callable[[], float]  #: returns the length of the step [s], when the contacts are detected


def usl(state: State, hook: Any, transfer: Transfer, clock: Clock, length: Length) -> float:
    """One step, update stress last: strain and positions follow from one grid velocity, which keeps rotation.

    1. φ_ip, ∇φ_ip
    2. m_i = Σ φ m,  (m v)_i = Σ φ m (v + C (x_i − x_p)), per velocity field; contacts are detected, Δt is
       chosen
    3. f_i = −Σ V σ·∇φ + f_ext + f_cont                     (eq. 12 of [H17])
    4. (m v)_i += Δt f_i, then velocity-correcting contact, inertia correction, boundary conditions
    5. v_p, x_p, C_p from the grid; surface nodes move with the same velocity
    6. F ← (1 + Δt L) F, domains, σ(F)
    """
    p, g = state.particles, state.grid
    phi, dt = begin(state, hook, clock, length)  # 1, 2, and −Σ V σ·∇φ

    clock("force")
    add_forces(state, hook, phi, dt)  # 3, 4

    clock("gather")
    gather(p, phi, g, transfer, dt)  # 5
    transport_affine(p, transfer, g, dt)
    hook.advect(grid=g, dt=dt)

    clock("material")
    hook.after_velocity_gradient(particles=p.in_space, grid=g, phi=phi, dt=dt)
    update_deformation(state, dt)  # 6
    hook.update_particle_domains(particles=p, grid=g, dt=dt)
    hook.update_stress(particles=p.in_space, dt=dt)
    hook.end_step(state=state)
    return dt


def musl(state: State, hook: Any, transfer: Transfer, clock: Clock, length: Length) -> float:
    """One step, modified update stress last (Sulsky, Zhou & Schreyer 1995).

    The strain is taken from the points' new velocities, projected a second time. This keeps nearly massless
    nodes from spoiling it (linear shape functions need that), at the price of two velocities for position and
    strain, which is wrong for rotation. Steps 1 to 4 are those of :func:`usl`.

    5. v_p, x_p, C_p from the grid; surface nodes and domains move with the same velocity
    6. (m v)_i = Σ φ m v again, boundary conditions; L from it
    7. F ← (1 + Δt L) F, σ(F)
    """
    p, g = state.particles, state.grid
    phi, dt = begin(state, hook, clock, length)  # 1, 2, and −Σ V σ·∇φ

    clock("force")
    add_forces(state, hook, phi, dt)  # 3, 4

    clock("gather")
    old_position = p.position if p.affine is None else p.position.copy()
    gather(p, phi, g, transfer, dt, strain=False)  # 5
    hook.advect(grid=g, dt=dt)
    hook.update_particle_domains(particles=p, grid=g, dt=dt)

    clock("projection")
    project_again(p, phi, g, old_position)  # 6
    hook.after_second_projection(grid=g, phi=phi, particles=p)
    hook.constrain_momentum(grid=g, time=state.time + dt)
    velocity_of_momentum(g.mass, g.momentum, g.velocity, g.spacing)
    clock("gather")
    gather_velocity_gradient(p, phi, g)
    transport_affine(p, transfer, g, dt)

    clock("material")
    hook.after_velocity_gradient(particles=p.in_space, grid=g, phi=phi, dt=dt)
    update_deformation(state, dt)  # 7
    hook.update_stress(particles=p.in_space, dt=dt)
    hook.end_step(state=state)
    return dt


def usf(state: State, hook: Any, transfer: Transfer, clock: Clock, length: Length) -> float:
    """One step, update stress first (Bardenhagen 2002): from the projected velocity, before the forces.

    Steps 1 and 2 are those of :func:`usl`; then contact and boundary conditions act on the momentum.

    3. L from it; F ← (1 + Δt L) F, σ(F)
    4. f_i = −Σ V σ·∇φ + f_ext + f_cont                     (eq. 12 of [H17])
    5. (m v)_i += Δt f_i, then velocity-correcting contact, inertia correction, boundary conditions
    6. v_p, x_p, C_p from the grid; surface nodes move with the same velocity; domains
    """
    p, g = state.particles, state.grid
    phi, dt = begin(state, hook, clock, length, force=False)  # 1, 2
    hook.constrain_momentum(grid=g, time=state.time)
    velocity_of_momentum(g.mass, g.momentum, g.velocity, g.spacing)

    clock("material")
    gather_velocity_gradient(p, phi, g)  # 3
    hook.after_velocity_gradient(particles=p.in_space, grid=g, phi=phi, dt=dt)
    update_deformation(state, dt)
    hook.update_stress(particles=p.in_space, dt=dt)

    clock("force")
    add_internal_force(p, phi, g)
    add_forces(state, hook, phi, dt)  # 4, 5

    clock("gather")
    gather(p, phi, g, transfer, dt)  # 6
    transport_affine(p, transfer, g, dt)
    hook.advect(grid=g, dt=dt)
    hook.update_particle_domains(particles=p, grid=g, dt=dt)
    hook.end_step(state=state)
    return dt


SCHEMES = {"usl": usl, "musl": musl, "usf": usf}


def begin(state: State, hook: Any, clock: Clock, length: Length, force: bool = True) -> tuple[Stencil, float]:
    """Fill the tables, project, with internal ``force`` or without, detect contacts; return φ and Δt."""
    p, g = state.particles, state.grid
    clock("shape")
    phi = interpolate(state, hook, clock)
    clock("projection")
    project(p, phi, g, force=force)
    hook.detect(grid=g, phi=phi, particles=p)
    dt = length()
    hook.after_momentum_projection(grid=g, phi=phi, particles=p, dt=dt)
    return phi, dt


def interpolate(state: State, hook: Any, clock: Clock) -> Stencil:
    """φ_ip and ∇φ_ip, and N_i(x_s) where surfaces are tracked; return the points' table.

    Windows are laid anew when a body leaves its own. Raise SimulationError for a point outside the background
    grid.
    """
    try:
        return _fill_tables(state, hook, clock)
    except OutsideGrid:
        fit_windows(state, hook)
        if state.particles.threads is not None:
            state.particles.threads.share_anew()
    try:
        return _fill_tables(state, hook, clock)
    except OutsideGrid as error:
        what = "a surface node" if error.surface else "a material point"
        advice = "a larger grid (grid.lower, grid.upper), or an earlier time.end; if the position is far off"
        raise state.error_at(
            error.index, f"{what} left the grid", surface=error.surface,
            advice=f"{advice} or nan, a smaller time.safety",
        ) from None  # fmt: skip


def _fill_tables(state: State, hook: Any, clock: Clock) -> Stencil:
    particles, grid, surface = state.particles, state.grid, state.surface
    phi: Stencil = hook.interpolate(particles=particles, grid=grid)
    if particles.threads is not None:
        particles.threads.share_nodes(phi)
    if surface is not None:
        clock(surface.stage)
        position, first = surface.position, surface.first
        if state.rigid is not None:
            position, first = position[: surface.on_grid], first[: len(first) - grid.rigid_fields]
        try:
            table = hook.interpolate_surface(position=position, first=first, grid=grid)
        except OutsideGrid as error:
            raise OutsideGrid(error.index, surface=True) from None
        if surface.table is not table:
            surface.table = table
        if state.self_contact is not None:
            phi = state.self_contact.divide(phi, grid)
        if state.rigid is not None:
            surface.table = state.rigid.with_points(table)
    return phi


def _over_points(p: Particles, kernel: Callable[..., Any], *given: Any) -> Any:
    """Run a kernel in which no point needs another; threads share out the points."""
    return kernel(p, *given) if p.threads is None else p.threads.over_points(kernel, p, *given)


def _over_nodes(p: Particles, kernel: Callable[..., Any], *given: Any) -> None:
    """Run a kernel in which points add to nodes; threads share out the nodes."""
    if p.threads is None:
        kernel(p, *given)
    else:
        p.threads.over_nodes(kernel, p, *given)


def _kernels_of(phi: Stencil) -> tuple[Any, Any]:
    """Kernels between points and nodes, and what they read: of products the factors."""
    return (particle_grid, phi) if phi.factors is None else (products, phi.factors)


def project(p: Particles, phi: Stencil, g: Grid, *, force: bool = False) -> None:
    """m_i, (m v)_i and v_i⁰; forces become −Σ V σ·∇φ, or zero without ``force``."""
    kernels, table = _kernels_of(phi)
    for array in (g.mass, g.momentum, g.force):
        array.fill(0.0)
    _apply_moment(p, phi, g, p.position)
    if force:
        _over_nodes(p, kernels.project_with_force, p.affine, p.thickness, table, g, g.spacing)
        _add_hoop_force(p, phi, g)
    else:
        _over_nodes(p, kernels.project, p.position, p.affine, table, g, g.mass, g.spacing)
    velocity_of_momentum(g.mass, g.momentum, g.start_velocity, g.spacing)


def project_again(p: Particles, phi: Stencil, g: Grid, position: FloatArray) -> None:
    """(m v)_i of the new v and C, at the ``position`` that φ belongs to (MUSL)."""
    _apply_moment(p, phi, g, position)
    g.momentum.fill(0.0)
    kernels, table = _kernels_of(phi)
    _over_nodes(p, kernels.project, position, p.affine, table, g, None, g.spacing)


def _apply_moment(p: Particles, phi: Stencil, g: Grid, position: FloatArray) -> None:
    """C_p = B_p D_p⁻¹, for a transfer that stores the moment B_p."""
    if p.moment is not None and p.affine is not None:
        _over_points(p, particle_grid.affine_from_moment, position, p.moment, p.affine, phi, g, g.spacing)


def add_internal_force(p: Particles, phi: Stencil, g: Grid) -> None:
    """f_i −= Σ V σ·∇φ, and of bodies of revolution Σ V σ_θθ φ / r."""
    _over_nodes(p, particle_grid.add_internal_force, p.thickness, phi, g, g.spacing)
    _add_hoop_force(p, phi, g)


def _add_hoop_force(p: Particles, phi: Stencil, g: Grid) -> None:
    if p.in_space is not p:
        p.in_space.add_hoop_force(p, phi, g, _over_nodes)


def add_forces(state: State, hook: Any, phi: Stencil, dt: float) -> None:
    """All forces but the internal ones, which g has, (m v)_i += Δt f_i, its corrections, and v_i."""
    p, g = state.particles, state.grid
    hook.add_nodal_force(grid=g, state=state, phi=phi, dt=dt)
    integrate_momentum(g.mass, g.momentum, g.force, dt, g.spacing)
    hook.after_momentum_update(grid=g, phi=phi, particles=p, dt=dt)
    hook.correct_inertia(grid=g, phi=phi, particles=p, dt=dt)
    hook.constrain_momentum(grid=g, time=state.time + dt)
    velocity_of_momentum(g.mass, g.momentum, g.velocity, g.spacing)


def gather(
    p: Particles, phi: Stencil, g: Grid, transfer: Transfer, dt: float, *, strain: bool = True
) -> None:
    """v_p, x_p, L_p of the ``strain`` and the affine field, which is not transported yet."""
    kind = transfer.affine
    affine = p.moment if kind == "moment" else p.affine if kind == "least_squares" else None
    factor = 1.0 if kind == "moment" else transfer.inverse_spread
    rate = p.velocity_gradient if strain else p.affine if kind == "gradient" else None
    kernels, table = _kernels_of(phi)
    _over_points(p, kernels.gather, affine, rate, table, g, factor, transfer.flip, dt, g.spacing)
    if strain and kind == "gradient" and p.affine is not None:
        p.affine[...] = p.velocity_gradient


def gather_velocity_gradient(p: Particles, phi: Stencil, g: Grid) -> None:
    """L_p = Σ v_i ∇φᵀ of the grid's velocity now."""
    _over_points(p, particle_grid.gather_velocity_gradient, phi, g, g.spacing)


def transport_affine(p: Particles, transfer: Transfer, g: Grid, dt: float) -> None:
    """C ← C (1 + Δt C)⁻¹, for a transfer whose affine field is transported."""
    if transfer.transported and p.affine is not None:
        _over_points(p, motion.transport_affine, p.affine, dt, g.spacing)


def update_deformation(state: State, dt: float) -> None:
    """F ← (1 + Δt L) F, V = det(F) V_0; raise Diverged unless det F > 0."""
    p = state.particles
    bad = _over_points(p.in_space, motion.update_deformation, dt, state.grid.tensor_spacing)
    if bad < 0:
        if p.in_space is not p:
            p.deformation_gradient[...] = p.in_space.deformation_gradient[:, :2, :2]
        return
    jacobian = p.volume[bad] / p.initial_volume[bad]
    inverted = f"a material point inverted (det F = {jacobian:.3g})"
    raise Diverged(inverted if jacobian == jacobian else "a value became NaN", bad)
