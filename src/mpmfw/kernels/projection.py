"""Kernels from material points to the grid (steps 2 and 3 of the time step)."""

from __future__ import annotations

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.rows import add_scaled_row, set_scaled_row
from mpmfw.kernels.small_matrix import invert
from mpmfw.kernels.table import NodeRange, entries, is_apart, own_entries
from mpmfw.kernels.types import Floats, Nodes, Points, Table


@device
def _velocity_at_origin(
    points: Points, position: Floats, affine: Floats | None, p: int, v: Floats, columns: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """v[0] = v_p − C_p x_p and columns = C_pᵀ, so that v_p + C_p (x − x_p) = v[0] + Σ_e x_e columns[e]."""
    dim = len(spacing)
    for d in range(dim):
        v[0, d] = points.velocity[p, d]
        if affine is not None:
            for e in range(dim):
                columns[e, d] = affine[p, d, e]
                v[0, d] -= columns[e, d] * position[p, e]


@kernel
def project_mass_momentum(
    points: Points, affine: Floats | None, table: Table, grid: Nodes, spacing: tuple[float, ...],
    own_nodes: NodeRange | None = None,
) -> None:  # fmt: skip
    """m_i += Σ_p φ_ip m_p and (m v)_i += Σ_p φ_ip m_p (v_p + C_p (x_i − x_p)); C_p is left out where
    ``affine`` is None."""
    dim = len(spacing)
    v = scratch.matrix((0.0,), spacing)
    v_i = scratch.matrix((0.0,), spacing)
    columns = scratch.matrix(spacing, spacing)
    for p in range(len(points.mass)):
        if own_nodes is not None and is_apart(table.row, table.nodes, p, own_nodes):
            continue
        m = points.mass[p]
        _velocity_at_origin(points, points.position, affine, p, v, columns, spacing)
        for k in own_entries(table.row, table.nodes, p, own_nodes):
            i = table.nodes[k]
            phi_m = table.weight[k] * m
            set_scaled_row(v_i, 0, 1.0, v, 0, spacing)
            if affine is not None:
                for e in range(dim):
                    add_scaled_row(v_i, 0, grid.position[i, e], columns, e, spacing)
            grid.mass[i] += phi_m
            add_scaled_row(grid.momentum, i, phi_m, v_i, 0, spacing)


@kernel
def project_momentum(
    points: Points, position: Floats, affine: Floats | None, table: Table, grid: Nodes,
    spacing: tuple[float, ...], own_nodes: NodeRange | None = None,
) -> None:  # fmt: skip
    """(m v)_i += Σ_p φ_ip m_p (v_p + C_p (x_i − x_p)) alone: the second projection of MUSL.

    ``position`` (n, dim) [m] is that of the points which the table belongs to.
    """
    dim = len(spacing)
    v = scratch.matrix((0.0,), spacing)
    v_i = scratch.matrix((0.0,), spacing)
    columns = scratch.matrix(spacing, spacing)
    for p in range(len(points.mass)):
        if own_nodes is not None and is_apart(table.row, table.nodes, p, own_nodes):
            continue
        m = points.mass[p]
        _velocity_at_origin(points, position, affine, p, v, columns, spacing)
        for k in own_entries(table.row, table.nodes, p, own_nodes):
            i = table.nodes[k]
            set_scaled_row(v_i, 0, 1.0, v, 0, spacing)
            if affine is not None:
                for e in range(dim):
                    add_scaled_row(v_i, 0, grid.position[i, e], columns, e, spacing)
            add_scaled_row(grid.momentum, i, table.weight[k] * m, v_i, 0, spacing)


@kernel
def add_internal_force(
    points: Points, thickness: Floats | None, table: Table, grid: Nodes, spacing: tuple[float, ...],
    own_nodes: NodeRange | None = None,
) -> None:  # fmt: skip
    """f_i −= Σ_p V_p σ_p · ∇φ_ip, with V_p times ``thickness`` (n,) [m] unless that is None."""
    dim = len(spacing)
    columns = scratch.matrix(spacing, spacing)
    force = scratch.matrix((0.0,), spacing)
    for p in range(len(points.volume)):
        if own_nodes is not None and is_apart(table.row, table.nodes, p, own_nodes):
            continue
        volume = points.volume[p]
        if thickness is not None:
            volume *= thickness[p]
        for d in range(dim):
            for e in range(dim):
                columns[e, d] = -volume * points.stress[p, d, e]
        for k in own_entries(table.row, table.nodes, p, own_nodes):
            set_scaled_row(force, 0, table.gradient[k, 0], columns, 0, spacing)
            for e in range(1, dim):
                add_scaled_row(force, 0, table.gradient[k, e], columns, e, spacing)
            add_scaled_row(grid.force, table.nodes[k], 1.0, force, 0, spacing)


@kernel
def affine_from_moment(
    points: Points, position: Floats, moment: Floats, affine: Floats, table: Table, grid: Nodes,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """C_p = B_p D_p⁻¹ with D_p = Σ_i φ_ip q qᵀ, q = x_i − x_p, at the present stencil (APIC).

    An axis along which a point sits on its node has no spread; D and B vanish there together and so does C.
    ``position`` (n, dim) [m] is that of the points which the table belongs to.
    """
    dim = len(spacing)
    x = scratch.vector(spacing)
    q = scratch.matrix((0.0,), spacing)
    spread = scratch.matrix(spacing, spacing)
    inverse = scratch.matrix(spacing, spacing)
    tiny = 1e-10 * spacing[0] * spacing[0]
    for p in range(len(points.mass)):
        for d in range(dim):
            x[d] = position[p, d]
            for e in range(dim):
                spread[d, e] = tiny if d == e else 0.0
        for k in entries(table.row, p):
            for d in range(dim):
                q[0, d] = grid.position[table.nodes[k], d] - x[d]
            for d in range(dim):
                add_scaled_row(spread, d, table.weight[k] * q[0, d], q, 0, spacing)
        invert(spread, inverse, spacing)
        for d in range(dim):
            for e in range(dim):
                c = 0.0
                for a in range(dim):
                    c += moment[p, d, a] * inverse[a, e]
                affine[p, d, e] = c
