"""Kernels of a time step: from material points to the grid, on nodes alone, and from the grid to the points.

Arguments are those of the table in :mod:`mpmfw.kernels`, where shapes and units stand.
"""

from __future__ import annotations

import numpy as np

from mpmfw.kernels import lanes, scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.arithmetic import (
    add_outer_product,
    add_scaled_row,
    copy_matrix,
    invert,
    multiply,
    set_scaled_row,
)
from mpmfw.kernels.lanes import LANES, WIDTH
from mpmfw.kernels.stencil import NodeRange, entries, is_apart, node_of, own_entries
from mpmfw.kernels.types import Floats, Nodes, Points, Table


@device
def _velocity_at_origin(
    points: Points, position: Floats, affine: Floats | None, p: int, v: Floats, columns: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """v[0] = v_p − C_p x_p and columns = C_pᵀ, so that v_p + C_p (x − x_p) = v[0] + Σ_e x_e columns[e]."""
    for d in range(len(spacing)):
        v[0, d] = points.velocity[p, d]
        if affine is not None:
            for e in range(len(spacing)):
                columns[e, d] = affine[p, d, e]
                v[0, d] -= columns[e, d] * position[p, e]


@device
def set_traction(
    points: Points, thickness: Floats | None, p: int, out: Floats, spacing: tuple[float, ...]
) -> None:
    """out = −V_p σ_pᵀ, so that the force on a node is Σ_e ∂φ/∂x_e out[e]."""
    volume = points.volume[p]
    if thickness is not None:
        volume *= thickness[p]
    for d in range(len(spacing)):
        for e in range(len(spacing)):
            out[e, d] = -volume * points.stress[p, d, e]


@device
def _add_force(k: int, table: Table, traction: Floats, force: Floats, spacing: tuple[float, ...]) -> None:
    """f_i += Σ_e ∂φ/∂x_e traction[e] of entry k."""
    f = scratch.matrix((0.0,), spacing)
    set_scaled_row(f, 0, table.gradient[k, 0], traction, 0, spacing)
    for e in range(1, len(spacing)):
        add_scaled_row(f, 0, table.gradient[k, e], traction, e, spacing)
    add_scaled_row(force, node_of(table.nodes, k), 1.0, f, 0, spacing)


@device
def _project(
    points: Points, position: Floats, affine: Floats | None, thickness: Floats | None, table: Table,
    grid: Nodes, mass: Floats | None, force: Floats | None, spacing: tuple[float, ...],
    own_nodes: NodeRange | None,
) -> None:  # fmt: skip
    """Add to momentum, ``mass`` and ``force`` of the nodes in one pass over the table."""
    v, v_i = scratch.matrix((0.0,), spacing), scratch.matrix((0.0,), spacing)
    columns, x_i = scratch.matrix(spacing, spacing), scratch.matrix((0.0,), spacing)
    traction = scratch.matrix(spacing, spacing)
    for p in range(len(points.mass)):
        if own_nodes is not None and is_apart(table.row, table.nodes, p, own_nodes):
            continue
        m = points.mass[p]
        _velocity_at_origin(points, position, affine, p, v, columns, spacing)
        if force is not None:
            set_traction(points, thickness, p, traction, spacing)
        first, count = own_entries(table, p, own_nodes)
        for c in range(count):
            k = first + np.uint64(c)
            i = node_of(table.nodes, k)
            phi_m = table.weight[k] * m
            set_scaled_row(v_i, 0, 1.0, v, 0, spacing)
            if affine is not None:
                set_scaled_row(x_i, 0, 1.0, grid.position, i, spacing)
                for e in range(len(spacing)):
                    add_scaled_row(v_i, 0, x_i[0, e], columns, e, spacing)
            if mass is not None:
                mass[i] += phi_m
            add_scaled_row(grid.momentum, i, phi_m, v_i, 0, spacing)
            if force is not None:
                _add_force(k, table, traction, force, spacing)


@kernel
def project(
    points: Points, position: Floats, affine: Floats | None, table: Table, grid: Nodes, mass: Floats | None,
    spacing: tuple[float, ...], own_nodes: NodeRange | None = None,
) -> None:  # fmt: skip
    """(m v)_i += Σ_p φ_ip m_p (v_p + C_p (x_i − x_p)) and m_i += Σ_p φ_ip m_p.

    ``affine`` is C_p, ``mass`` m_i; either is left out where it is None. ``position`` (n, dim) [m] is that of
    the points which the table belongs to.
    """
    _project(points, position, affine, None, table, grid, mass, None, spacing, own_nodes)


@kernel
def project_with_force(
    points: Points, affine: Floats | None, thickness: Floats | None, table: Table, grid: Nodes,
    spacing: tuple[float, ...], own_nodes: NodeRange | None = None,
) -> None:  # fmt: skip
    """:func:`project` and :func:`add_internal_force` at once, which reads the table once."""
    mass, force = grid.mass, grid.force
    _project(points, points.position, affine, thickness, table, grid, mass, force, spacing, own_nodes)


@kernel
def add_internal_force(
    points: Points, thickness: Floats | None, table: Table, grid: Nodes, spacing: tuple[float, ...],
    own_nodes: NodeRange | None = None,
) -> None:  # fmt: skip
    """f_i −= Σ_p V_p σ_p · ∇φ_ip, with V_p times ``thickness`` (n,) [m] unless that is None."""
    traction = scratch.matrix(spacing, spacing)
    for p in range(len(points.volume)):
        if own_nodes is not None and is_apart(table.row, table.nodes, p, own_nodes):
            continue
        set_traction(points, thickness, p, traction, spacing)
        first, count = own_entries(table, p, own_nodes)
        for c in range(count):
            k = first + np.uint64(c)
            _add_force(k, table, traction, grid.force, spacing)


@kernel
def affine_from_moment(
    points: Points, position: Floats, moment: Floats, affine: Floats, table: Table, grid: Nodes,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """C_p = B_p D_p⁻¹ with D_p = Σ_i φ_ip q qᵀ, q = x_i − x_p, at the present stencil (APIC).

    An axis along which a point sits on its node has no spread; D and B vanish there together and so does C.
    ``position`` (n, dim) [m] is that of the points which the table belongs to.
    """
    x, q = scratch.matrix((0.0,), spacing), scratch.matrix((0.0,), spacing)
    spread, inverse = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    tiny = 1e-10 * spacing[0] * spacing[0]
    for p in range(len(points.mass)):
        for d in range(len(spacing)):
            x[0, d] = position[p, d]
            for e in range(len(spacing)):
                spread[d, e] = tiny if d == e else 0.0
        for k in entries(table.row, p):
            set_scaled_row(q, 0, 1.0, grid.position, table.nodes[k], spacing)
            add_scaled_row(q, 0, -1.0, x, 0, spacing)
            for d in range(len(spacing)):
                add_scaled_row(spread, d, table.weight[k] * q[0, d], q, 0, spacing)
        invert(spread, inverse, spacing)
        multiply(moment[p], inverse, affine[p], spacing)


@kernel
def velocity_of_momentum(
    mass: Floats, momentum: Floats, velocity: Floats, spacing: tuple[float, ...]
) -> None:
    """v_i = (m v)_i / m_i where there is mass, else 0; a mass of −1 marks a node that no force moves."""
    for i in range(len(mass)):
        inverse = 1.0 / mass[i] if mass[i] != 0.0 else 0.0
        for d in range(len(spacing)):
            velocity[i, d] = momentum[i, d] * inverse


@kernel
def integrate_momentum(
    mass: Floats, momentum: Floats, force: Floats, dt: float, spacing: tuple[float, ...]
) -> None:
    """(m v)_i += Δt f_i; nodes without mass stay at rest."""
    for i in range(len(mass)):
        if mass[i] > 0.0:
            for d in range(len(spacing)):
                momentum[i, d] += dt * force[i, d]


@kernel
def add_body_force(mass: Floats, acceleration: Floats, force: Floats, spacing: tuple[float, ...]) -> None:
    """f_i += m_i b."""
    for i in range(len(mass)):
        for d in range(len(spacing)):
            force[i, d] += mass[i] * acceleration[d]


@kernel
def gather(
    points: Points, affine: Floats | None, rate: Floats | None, table: Table, grid: Nodes,
    inverse_spread: float, flip: float, dt: float, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Velocity, position, velocity gradient and affine field of every material point.

    v_p ← flip (v_p + Σ φ (v_i − v_i⁰)) + (1 − flip) Σ φ v_i,  x_p ← x_p + Δt Σ φ v_i,  L_p = Σ v_i ∇φᵀ. v_i⁰
    is the velocity as projected, so that forces, contact, inertia correction and boundary conditions all
    reach v_p. With q = x_i − x_p at the old position, B_p = Σ φ v_i qᵀ and D_p = Σ φ q qᵀ, the affine field
    becomes B_p times ``inverse_spread``, or B_p D_p⁻¹ if that is 0; it is left out where ``affine`` is None,
    and L_p where ``rate`` is.
    """
    x, l = scratch.matrix((0.0,), spacing), scratch.matrix(spacing, spacing)
    phi_v, phi_q = scratch.matrix((0.0,), spacing), scratch.matrix((0.0,), spacing)
    q, v = scratch.matrix((0.0,), spacing), scratch.matrix((0.0,), spacing)
    new, start = scratch.matrix((0.0,), spacing), scratch.matrix((0.0,), spacing)
    moment, spread = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    moments = scratch.matrices(LANES, spacing, spacing)
    spreads = scratch.matrices(LANES, spacing, spacing)
    for p in range(len(points.mass)):
        set_scaled_row(x, 0, 1.0, points.position, p, spacing)
        set_scaled_row(v, 0, 1.0, points.velocity, p, spacing)
        for d in range(len(spacing)):
            new[0, d] = start[0, d] = 0.0
            for e in range(len(spacing)):
                l[d, e] = moment[d, e] = spread[d, e] = 0.0
        first, count = own_entries(table, p, None)
        for c in range(count):
            k = first + np.uint64(c)
            i = node_of(table.nodes, k)
            phi = table.weight[k]
            set_scaled_row(phi_v, 0, phi, grid.velocity, i, spacing)
            add_scaled_row(new, 0, 1.0, phi_v, 0, spacing)
            add_scaled_row(start, 0, phi, grid.start_velocity, i, spacing)
            if rate is not None:
                add_outer_product(l, grid.velocity, i, table.gradient, k, spacing)
            if affine is not None:
                set_scaled_row(q, 0, 1.0, grid.position, i, spacing)
                add_scaled_row(q, 0, -1.0, x, 0, spacing)
                add_outer_product(moment, phi_v, 0, q, 0, spacing)
                if inverse_spread == 0.0:
                    set_scaled_row(phi_q, 0, phi, q, 0, spacing)
                    add_outer_product(spread, phi_q, 0, q, 0, spacing)
        add_scaled_row(x, 0, dt, new, 0, spacing)
        add_scaled_row(v, 0, 1.0, new, 0, spacing)
        add_scaled_row(v, 0, -1.0, start, 0, spacing)
        set_scaled_row(v, 0, flip, v, 0, spacing)
        add_scaled_row(v, 0, 1.0 - flip, new, 0, spacing)
        set_scaled_row(points.position, p, 1.0, x, 0, spacing)
        set_scaled_row(points.velocity, p, 1.0, v, 0, spacing)
        if rate is not None:
            copy_matrix(rate, p, l, 0, spacing)
        if affine is not None:
            _store_affine(
                p, len(points.mass), moment, spread, moments, spreads, inverse_spread, affine, spacing
            )


@device
def _store_affine(
    p: int, end: int, moment: Floats, spread: Floats, moments: Floats, spreads: Floats, inverse_spread: float,
    affine: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """affine[p] = B times ``inverse_spread``; where that is 0, B D⁻¹ once all lanes have a point."""
    if inverse_spread != 0.0:
        for d in range(len(spacing)):
            set_scaled_row(moment, d, inverse_spread, moment, d, spacing)
        copy_matrix(affine, p, moment, 0, spacing)
        return
    for lane in range(p % WIDTH, WIDTH if p + 1 == end else p % WIDTH + 1):  # the last point fills the rest
        copy_matrix(moments, lane, moment, 0, spacing)
        copy_matrix(spreads, lane, spread, 0, spacing)
    if (p + 1) % WIDTH == 0 or p + 1 == end:
        b, tensor = lanes.matrix(spacing, spacing), lanes.matrix(spacing, spacing)
        inverse, product = lanes.matrix(spacing, spacing), lanes.matrix(spacing, spacing)
        lanes.read(moments, (0, 1, 2, 3), b, spacing)
        lanes.read(spreads, (0, 1, 2, 3), tensor, spacing)
        lanes.invert(tensor, inverse, spacing)
        lanes.multiply(b, inverse, product, spacing)
        lanes.write(affine, lanes.points_from(p - p % WIDTH, end), product, spacing)


@kernel
def gather_velocity_gradient(points: Points, table: Table, grid: Nodes, spacing: tuple[float, ...]) -> None:
    """L_p = Σ_i v_i ∇φ_ipᵀ [1/s] alone, of the grid's ``velocity``: MUSL and USF take the strain from it."""
    l = scratch.matrix(spacing, spacing)
    for p in range(len(points.mass)):
        for d in range(len(spacing)):
            for e in range(len(spacing)):
                l[d, e] = 0.0
        first, count = own_entries(table, p, None)
        for c in range(count):
            k = first + np.uint64(c)
            add_outer_product(l, grid.velocity, table.nodes[k], table.gradient, k, spacing)
        copy_matrix(points.velocity_gradient, p, l, 0, spacing)
