"""Windows of the velocity fields on the background grid, and the pairs of bodies that they list."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpmfw.kernels.facets import bounding_boxes
from mpmfw.state.fields import GRID_FIELDS, AnyArray, FloatArray, IntArray
from mpmfw.state.history import NotSaved
from mpmfw.state.structs import Grid, Pair, State

#: Nodes kept free round a body: room for supports, and for motion until windows are laid again.
MARGIN = 3

#: Number of bodies up to which all pairs are listed from the start.
FEW = 32


def make_grid(
    cell_size: float,
    lower: FloatArray,
    upper: FloatArray,
    n_fields: int,
    *,
    rigid_fields: int = 0,
    axisymmetric: bool = False,
) -> Grid:
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
        rigid_fields=rigid_fields,
        axisymmetric=axisymmetric,
    )


def fit_windows(state: State, hook: Any) -> None:
    """Lay every field's window round its points and surface nodes, with new nodal arrays of zeros; list the
    pairs that have come near."""
    state.grid.window_lower[:], state.grid.window_shape[:] = fitted_windows(state, hook)
    allocate_nodes(state.grid)
    update_pairs(state, hook)


def fitted_windows(state: State, hook: Any) -> tuple[IntArray, IntArray]:
    """Return the windows that :func:`fit_windows` lays, (n_fields, dim) each."""
    grid, particles, surface = state.grid, state.particles, state.surface
    reach = hook.particle_reach(particles=particles)
    low, high = particles.position - reach, particles.position + reach
    first, shape, n_fields = np.empty_like(grid.window_lower), np.empty_like(grid.window_shape), grid.n_fields
    for index in range(n_fields):
        own = slice(int(particles.first[index]), int(particles.first[index + 1]))
        if index >= n_fields - grid.rigid_fields:
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
    np.cumsum(grid.sheets * np.prod(grid.window_shape, axis=1), out=grid.offset[1:])
    sizes = {"node": int(grid.offset[-1]), "axis": dim}
    grid.set(**{field.name: field.allocate(sizes) for field in GRID_FIELDS})
    for f, (first, shape) in enumerate(zip(grid.window_lower, grid.window_shape, strict=True)):
        axes = [grid.lower[d] + h * (first[d] + np.arange(shape[d])) for d in range(dim)]
        positions = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        grid.position[grid.offset[f] : grid.offset[f + 1]].reshape(-1, *positions.shape)[:] = positions
    grid.frame += 1


def _node(grid: Grid, position: FloatArray) -> IntArray:
    index = np.floor((position - grid.lower) / grid.cell_size)
    node: IntArray = np.clip(np.nan_to_num(index), -10, grid.nodes + 10).astype(np.int64)
    return node


def overlapping(lower: AnyArray, upper: AnyArray) -> tuple[IntArray, IntArray]:
    """Return the indices of every two boxes that have a point in common, first < second, in ascending order.

    ``lower`` and ``upper`` are the corners (n, dim); a box with an infinite lower corner overlaps with none.
    """
    there = np.flatnonzero(np.isfinite(lower).all(axis=1))
    low, high = np.asarray(lower, dtype=float)[there], np.asarray(upper, dtype=float)[there]
    if len(there) < 2:
        return there[:0], there[:0]
    if len(there) <= FEW:
        first, second = np.triu_indices(len(there), 1)
        meet = ((low[first] <= high[second]) & (low[second] <= high[first])).all(axis=1)
        return there[first[meet]], there[second[meet]]
    import shapely  # the boxes meet in the plane of the axes along which they spread most

    axes = np.argsort((low + high).max(axis=0) - (low + high).min(axis=0))[-2:]
    flat = shapely.box(*low[:, axes].T, *high[:, axes].T)
    first, second = shapely.STRtree(flat).query(flat)
    meet = (first < second) & ((low[first] <= high[second]) & (low[second] <= high[first])).all(axis=1)
    order = np.lexsort((second[meet], first[meet]))
    return there[first[meet][order]], there[second[meet][order]]


@dataclass
class BodyPairs:
    """Adds to ``State.pairs`` the bodies that come near each other, each time that windows are laid.

    Near are bodies whose windows share a node, so that pairs are listed before they act; in one velocity
    field, bodies whose outlines' boxes are within a cell of each other at an output."""

    names: tuple[str, ...]  #: of all bodies
    friction: float  #: Coulomb's μ of pairs that are not in ``given``
    given: Mapping[tuple[int, int], float]  #: μ by the indices of both bodies, the lower first
    friction_law: str | None = None  #: that replaces μ in every row, if the scene names one
    _listed: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    _frame: int = 0

    def update(self, state: State) -> bool:
        """List pairs that have come near; return whether there are any."""
        grid = state.grid
        windows = grid.n_fields == len(self.names)
        if windows and grid.frame == self._frame:
            return False
        self._frame = grid.frame
        laid = slice(grid.n_fields - grid.rigid_fields)  # pairs with rigid bodies are listed already
        boxes = (grid.window_lower[laid], (grid.window_lower + grid.window_shape - 1)[laid])
        return self.add(state, *overlapping(*(boxes if windows else _outlines(state))))

    def add(self, state: State, first: IntArray, second: IntArray) -> bool:
        """List pairs that are new; return whether there are any."""
        return self._list(state, np.setdiff1d(first * len(self.names) + second, self._listed))

    def restore(self, state: State, bodies: IntArray) -> bool:
        """List the pairs of a state that was saved (n, 2), in their order; return whether any is new.

        Raise NotSaved if they are not pairs of the scene that begin with those already listed."""
        listed, count = state.pair_bodies, len(self.names)
        keys, first, second = np.array(bodies) @ np.array([count, 1]), bodies[:, 0], bodies[:, 1]
        valid = ((first >= 0) & (first <= second) & (second < count)).all()
        if not (
            valid and np.array_equal(bodies[: len(listed)], listed) and len(set(keys.tolist())) == len(keys)
        ):
            raise NotSaved("the pairs of bodies are not those of the scene")
        return self._list(state, keys[len(listed) :])

    def _list(self, state: State, new: IntArray) -> bool:
        """List pairs by the index ``first * bodies + second``."""
        self._listed = np.union1d(self._listed, new)
        pairs = list(state.pairs)
        for key in new.tolist():
            first, second = divmod(key, len(self.names))
            label = f"{self.names[first]}-{self.names[second]}"
            mu = self.given.get((first, second), self.friction)
            pairs.append(Pair(len(pairs), first, second, label, mu, self.friction_law))
        state.pairs = tuple(pairs)
        return len(new) > 0


def _outlines(state: State) -> tuple[AnyArray, AnyArray]:
    """Boxes of the outlines, wider by half a cell; infinite without."""
    lower = np.full((len(state.bodies), state.grid.dim), np.inf)
    upper = np.full_like(lower, -np.inf)
    if state.surface is not None:
        bounding_boxes(state.surface.body_first, state.surface.position, lower, upper)
    return lower - 0.5 * state.grid.cell_size, upper + 0.5 * state.grid.cell_size


def update_pairs(state: State, hook: Any) -> None:
    """List bodies that have come near each other, and notify the plug-ins."""
    if state.near is not None and state.near.update(state):
        hook.add_pairs(state=state)
