"""Laying the velocity fields' windows on the background grid."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.state.fields import GRID_FIELDS, FloatArray, IntArray
from mpmfw.state.history import NotSaved
from mpmfw.state.structs import Grid, Particles, Surface

#: Nodes kept free round a body: room for supports, and for motion until windows are laid again.
MARGIN = 3


def make_grid(cell_size: float, lower: FloatArray, upper: FloatArray, n_fields: int) -> Grid:
    """Return an empty grid from ``lower`` to at least ``upper``."""
    dim = len(lower)
    cells = np.ceil((upper - lower) / cell_size - 1e-9).astype(np.int64)
    sizes = {"node": 0, "axis": dim}
    arrays: dict[str, Any] = {field.name: field.allocate(sizes) for field in GRID_FIELDS}
    return Grid(
        cell_size=cell_size,
        lower=np.array(lower, dtype=float),
        nodes=cells + 1,
        window_lower=np.zeros((n_fields, dim), dtype=np.int64),
        window_shape=np.zeros((n_fields, dim), dtype=np.int64),
        offset=np.zeros(n_fields + 1, dtype=np.int64),
        **arrays,
        spacing=(float(cell_size),) * dim,
    )


def fit_windows(grid: Grid, particles: Particles, reach: FloatArray, surface: Surface | None) -> None:
    """Lay every field's window round its points and surface nodes, with new nodal arrays of zeros.

    ``reach`` (n, dim) [m] is half the extent of every domain."""
    grid.window_lower[:], grid.window_shape[:] = fitted_windows(grid, particles, reach, surface)
    allocate_nodes(grid)


def fitted_windows(
    grid: Grid, particles: Particles, reach: FloatArray, surface: Surface | None
) -> tuple[IntArray, IntArray]:
    """Return the windows that :func:`fit_windows` lays, (n_fields, dim) each."""
    low, high = particles.position - reach, particles.position + reach
    first, shape = np.empty_like(grid.window_lower), np.empty_like(grid.window_shape)
    for index in range(grid.n_fields):
        own = slice(int(particles.first[index]), int(particles.first[index + 1]))
        if index >= grid.n_fields - grid.rigid_fields:
            first[index], shape[index] = _rigid_window(grid)
            continue
        lower, upper = low[own].min(axis=0), high[own].max(axis=0)
        if surface is not None:
            nodes = surface.position[int(surface.first[index]) : int(surface.first[index + 1])]
            if len(nodes):
                lower = np.minimum(lower, nodes.min(axis=0))
                upper = np.maximum(upper, nodes.max(axis=0))
        start = _node(grid, lower) - MARGIN
        stop = _node(grid, upper) + 1 + MARGIN
        first[index] = np.clip(start, 0, grid.nodes - 1)
        shape[index] = np.clip(stop, 0, grid.nodes - 1) - first[index] + 1
    return first, shape


def _rigid_window(grid: Grid) -> tuple[IntArray, IntArray]:
    """Return the window of the dim + 1 points of mass of a rigid body, beyond all other windows."""
    shape = np.ones_like(grid.nodes)
    shape[0] = grid.dim + 1
    return grid.nodes + 1, shape


def is_cut_off(grid: Grid) -> bool:
    """Return True if a window ends where the background grid does."""
    last = grid.window_lower + grid.window_shape
    return bool((grid.window_lower == 0).any() or (last == grid.nodes).any())


def set_windows(grid: Grid, lower: IntArray, shape: IntArray, most: float = np.inf) -> None:
    """Lay the windows at given nodes, (n_fields, dim) each, of the background grid.

    Raise NotSaved if they are not within the grid, or have more than ``most`` nodes."""
    laid = slice(grid.n_fields - grid.rigid_fields)
    within = lower.shape == shape.shape == grid.window_lower.shape and bool(
        (lower >= 0).all()
        and (shape >= 1).all()
        and (lower <= grid.nodes - shape)[laid].all()
        and (np.stack([lower, shape])[:, laid.stop :] == np.stack(_rigid_window(grid))[:, None]).all()
    )
    if not within or np.prod(shape, axis=1, dtype=float).sum() > most:
        raise NotSaved("the windows of the velocity fields are not within the grid")
    grid.window_lower[:], grid.window_shape[:] = lower, shape
    allocate_nodes(grid)


def allocate_nodes(grid: Grid) -> None:
    """Allocate nodal arrays, all zero, and place the nodes of the windows as they are.

    The position of a node is the same to the last bit in every window that holds it."""
    dim, h = grid.dim, grid.cell_size
    np.cumsum(np.prod(grid.window_shape, axis=1), out=grid.offset[1:])
    sizes = {"node": int(grid.offset[-1]), "axis": dim}
    grid.set(**{field.name: field.allocate(sizes) for field in GRID_FIELDS})
    for f, (first, shape) in enumerate(zip(grid.window_lower, grid.window_shape, strict=True)):
        axes = [grid.lower[d] + h * (first[d] + np.arange(shape[d])) for d in range(dim)]
        positions = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        grid.position[grid.field_nodes(f)] = positions.reshape(-1, dim)
    grid.frame += 1


def _node(grid: Grid, position: FloatArray) -> IntArray:
    index = np.floor((position - grid.lower) / grid.cell_size)
    node: IntArray = np.clip(np.nan_to_num(index), -10, grid.nodes + 10).astype(np.int64)
    return node
