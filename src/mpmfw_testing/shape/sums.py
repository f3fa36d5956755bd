"""Sums over the entries of a table."""

from __future__ import annotations

import numpy as np

from mpmfw.state.fields import FloatArray, IntArray
from mpmfw.state.structs import Grid, Stencil


def entries_of(table: Stencil, point: int) -> slice:
    """Entries of one point."""
    return slice(int(table.row[point]), int(table.row[point + 1]))


def owners(table: Stencil) -> IntArray:
    """Point that each entry belongs to, (n_entries,)."""
    points: IntArray = np.repeat(np.arange(len(table.row) - 1), np.diff(table.row))
    return points


def at_nodes(table: Stencil, point_values: FloatArray, grid: Grid) -> FloatArray:
    """Σ_p φ_ip a_p of point values (n, k) at all nodes, (n_nodes, k)."""
    total = np.zeros((len(grid.position), point_values.shape[1]))
    used = len(owners(table))
    np.add.at(total, table.nodes[:used], table.weight[:used, None] * point_values[owners(table)])
    return total


def gradient_at_nodes(table: Stencil, volume: FloatArray, grid: Grid) -> FloatArray:
    """Σ_p V_p ∇φ_ip at all nodes, (n_nodes, dim): minus the internal force of a unit stress."""
    total = np.zeros(grid.position.shape)
    used = len(owners(table))
    np.add.at(total, table.nodes[:used], volume[owners(table), None] * table.gradient[:used])
    return total


def node_numbers(table: Stencil, point: int, grid: Grid) -> IntArray:
    """Background indices of the nodes of one point's entries, (k, dim)."""
    position = grid.position[table.nodes[entries_of(table, point)]]
    numbers: IntArray = np.rint((position - grid.lower) / grid.cell_size).astype(np.int64)
    return numbers


def dense(table: Stencil, point: int, grid: Grid) -> tuple[FloatArray, FloatArray]:
    """φ and ∇φ h of one point on the whole background grid, (n_1, n_2[, n_3]) and the same with a last axis
    dim.

    Entries that name the same node twice are added, as every kernel does.
    """
    own = entries_of(table, point)
    where = tuple(node_numbers(table, point, grid).T)
    weight = np.zeros(grid.nodes)
    gradient = np.zeros((*grid.nodes, grid.dim))
    np.add.at(weight, where, table.weight[own])
    if len(table.gradient):
        np.add.at(gradient, where, table.gradient[own] * grid.cell_size)
    return weight, gradient


def unity_error(table: Stencil, point: int) -> float:
    """|Σ φ − 1|."""
    return abs(float(table.weight[entries_of(table, point)].sum()) - 1.0)


def linear_error(table: Stencil, point: int, position: FloatArray, grid: Grid) -> float:
    """|Σ φ x_i − x_p| [cells], the largest component."""
    own = entries_of(table, point)
    offset = (grid.position[table.nodes[own]] - position) / grid.cell_size
    return float(np.abs(table.weight[own] @ offset).max())


def gradient_errors(table: Stencil, point: int, position: FloatArray, grid: Grid) -> tuple[float, float]:
    """Largest components of h Σ ∇φ and of Σ x_i ⊗ ∇φ − 1."""
    own = entries_of(table, point)
    gradient = table.gradient[own] * grid.cell_size
    offset = (grid.position[table.nodes[own]] - position) / grid.cell_size
    return float(np.abs(gradient.sum(axis=0)).max()), float(
        np.abs(offset.T @ gradient - np.eye(grid.dim)).max()
    )


def spread(table: Stencil, point: int, position: FloatArray, grid: Grid) -> FloatArray:
    """D_p = Σ φ q qᵀ, q = x_i − x_p, (dim, dim) [cells²]."""
    own = entries_of(table, point)
    q = (grid.position[table.nodes[own]] - position) / grid.cell_size
    total: FloatArray = (table.weight[own, None] * q).T @ q
    return total
