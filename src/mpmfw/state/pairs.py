"""The pairs of bodies that a run lists: of many bodies those that have come near each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpmfw.kernels.boxes import bounding_boxes, sweep_strips
from mpmfw.state.fields import AnyArray, FloatArray, IntArray
from mpmfw.state.history import NotSaved
from mpmfw.state.structs import Pair, State

#: Number of bodies up to which all pairs are listed from the start.
FEW = 32


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
    entries = _strips(low, high)
    room = 8 * len(there)
    while True:
        first, second = np.zeros(room, dtype=np.int64), np.zeros(room, dtype=np.int64)
        count, _ = sweep_strips(*entries, low, high, first, second)
        if count <= room:
            break
        room = count
    order = np.lexsort((second[:count], first[:count]))
    return there[first[:count][order]], there[second[:count][order]]


def _strips(lower: FloatArray, upper: FloatArray) -> tuple[int, IntArray, IntArray, IntArray]:
    """Axis of the sweep, and entries of boxes in strips across the axis of next to the largest spread.

    A strip is as wide as the median box, and there are no more strips than boxes."""
    spread = (lower + upper).max(axis=0) - (lower + upper).min(axis=0)
    across, along = (int(axis) for axis in np.argsort(spread)[-2:])
    start, end = lower[:, across].min(), upper[:, across].max()
    width = max(float(np.median(upper[:, across] - lower[:, across])), (end - start) / len(lower))
    first, last = (
        np.floor((corner[:, across] - start) / width if width > 0.0 else 0.0 * corner[:, across])
        for corner in (lower, upper)
    )
    lowest = first.astype(np.int64)
    counts = last.astype(np.int64) - lowest + 1
    box = np.repeat(np.arange(len(lower)), counts)
    place = np.arange(len(box)) - np.repeat(np.cumsum(counts) - counts, counts)
    strip = lowest[box] + place
    order = np.lexsort((lower[box, along], strip))
    return along, strip[order], box[order], lowest


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

    @property
    def has_friction(self) -> bool:
        """True if any two bodies have friction."""
        return self.friction > 0.0 or any(mu > 0.0 for mu in self.given.values())

    def pair(self, index: int, first: int, second: int) -> Pair:
        """The facts of two bodies' interface."""
        label = f"{self.names[first]}-{self.names[second]}"
        mu = self.given.get((first, second), self.friction)
        return Pair(index, first, second, label, mu, self.friction_law)

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
        valid = ((first >= 0) & (first < second) & (second < count)).all()
        if not (
            valid and np.array_equal(bodies[: len(listed)], listed) and len(set(keys.tolist())) == len(keys)
        ):
            raise NotSaved("the pairs of bodies are not those of the scene")
        return self._list(state, keys[len(listed) :])

    def _list(self, state: State, new: IntArray) -> bool:
        """List pairs by the index ``first * bodies + second``."""
        self._listed = np.union1d(self._listed, new)
        start = len(state.pairs)
        bodies = (divmod(key, len(self.names)) for key in new.tolist())
        state.pairs += tuple(self.pair(start + k, a, b) for k, (a, b) in enumerate(bodies))
        return len(new) > 0


def _outlines(state: State) -> tuple[AnyArray, AnyArray]:
    """Boxes of the outlines, wider by half a cell; infinite without."""
    lower = np.full((len(state.bodies), state.grid.dim), np.inf)
    upper = np.full_like(lower, -np.inf)
    if state.surface is not None:
        bounding_boxes(state.surface.body_first, state.surface.position, lower, upper)
    return lower - 0.5 * state.grid.cell_size, upper + 0.5 * state.grid.cell_size


def update_pairs(state: State, hook: Any) -> None:
    """List bodies that have come near each other, and tell the plug-ins."""
    if state.near is not None and state.near.update(state):
        hook.add_pairs(state=state)
