"""Sums over the entries of a table."""

from __future__ import annotations

import numpy as np

from mpmfw.state.fields import FloatArray, IntArray
from mpmfw.state.structs import Grid, Stencil


def entries_of(table: Stencil, point: int) -> slice:
    """Return the entries of one point."""
    return slice(int(table.row[point]), int(table.row[point + 1]))


def owners(table: Stencil) -> IntArray:
    """Return the point that each entry belongs to, (n_entries,)."""
    points: IntArray = np.repeat(np.arange(len(table.row) - 1), np.diff(table.row))
    return points


def at_nodes(table: Stencil, values: FloatArray, grid: Grid) -> FloatArray:
    """Return Σ_p φ_ip a_p of values (n, k) of points at all nodes, (n_nodes, k)."""
    total = np.zeros((len(grid.position), values.shape[1]))
    points = owners(table)
    np.add.at(total, table.nodes[: len(points)], table.weight[: len(points), None] * values[points])
    return total


def gradient_at_nodes(table: Stencil, volume: FloatArray, grid: Grid) -> FloatArray:
    """Return Σ_p V_p ∇φ_ip at all nodes, (n_nodes, dim): minus the internal force of a unit stress."""
    total = np.zeros(grid.position.shape)
    points = owners(table)
    np.add.at(total, table.nodes[: len(points)], volume[points, None] * table.gradient[: len(points)])
    return total


def dense(table: Stencil, point: int, grid: Grid) -> tuple[FloatArray, FloatArray]:
    """Return φ and ∇φ h of one point on the background grid, (n_1, n_2[, n_3]) and with a last axis dim.

    Entries that name the same node twice are added, as every kernel does.
    """
    own = entries_of(table, point)
    numbers = np.rint((grid.position[table.nodes[own]] - grid.lower) / grid.cell_size).astype(np.int64)
    weight, gradient = np.zeros(grid.nodes), np.zeros((*grid.nodes, grid.dim))
    np.add.at(weight, tuple(numbers.T), table.weight[own])
    if len(table.gradient):
        np.add.at(gradient, tuple(numbers.T), table.gradient[own] * grid.cell_size)
    return weight, gradient


def offsets(table: Stencil, point: int, position: FloatArray, grid: Grid) -> FloatArray:
    """Return q = x_i − x_p of the entries of one point, (k, dim) [cells]."""
    return (grid.position[table.nodes[entries_of(table, point)]] - position) / grid.cell_size


def unity_error(table: Stencil, point: int) -> float:
    """Return |Σ φ − 1|."""
    return abs(float(table.weight[entries_of(table, point)].sum()) - 1.0)


def linear_error(table: Stencil, point: int, position: FloatArray, grid: Grid) -> float:
    """Return |Σ φ x_i − x_p| [cells], the largest component."""
    q = offsets(table, point, position, grid)
    return float(np.abs(table.weight[entries_of(table, point)] @ q).max())


def gradient_errors(table: Stencil, point: int, position: FloatArray, grid: Grid) -> tuple[float, float]:
    """Return the largest components of h Σ ∇φ and of Σ x_i ⊗ ∇φ − 1."""
    gradient = table.gradient[entries_of(table, point)] * grid.cell_size
    tensor = offsets(table, point, position, grid).T @ gradient
    return float(np.abs(gradient.sum(axis=0)).max()), float(np.abs(tensor - np.eye(grid.dim)).max())
