"""Broad phase: which segments a surface node may touch, from trees over nodes and midpoints of segments."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from mpmfw.api import FloatArray, IntArray, Surface
from mpmfw.kernels.polyline import bounding_boxes


class Neighbours:
    """Rows of possible contacts: a slave node, the body it may touch, and that body's segments nearby.

    Segments of row r are ``segment[first[r]:first[r + 1]]``. The rows are found anew only after a surface node has moved
    by a quarter of ``skin``, and there are none while the boxes of all pairs are farther apart than ``reach``.

    Parameters
    ----------
    surface
        Tracked outlines of all bodies.
    slave, master
        Body of the nodes and body of the segments, one entry for every pair and direction.
    reach
        Distance within which contacts must be found [m].
    skin
        Additional distance that is searched, so that a search lasts for several steps [m].
    """

    def __init__(
        self, surface: Surface, slave: IntArray, master: IntArray, reach: float, skin: float
    ) -> None:
        self.surface, self.slave_body, self.master_body = surface, slave, master
        self.reach, self.skin = reach, skin
        bodies = len(surface.body_first) - 1
        self.lower, self.upper = np.zeros((bodies, 2)), np.zeros((bodies, 2))
        self.forget()

    def forget(self) -> None:
        """No rows; the next call searches anew."""
        self.node: IntArray = np.zeros(0, dtype=np.int64)  #: (n_rows,) slave node
        self.direction: IntArray = np.zeros(0, dtype=np.int64)  #: (n_rows,) entry of ``slave`` and ``master``
        self.first: IntArray = np.zeros(1, dtype=np.int64)  #: (n_rows + 1,)
        self.segment: IntArray = np.zeros(0, dtype=np.int64)  #: first node of the segment
        self.near: IntArray = np.zeros(0, dtype=np.int64)  #: directions whose boxes are near
        self.searched_at: FloatArray | None = None

    @property
    def key(self) -> IntArray:
        """(n_rows,) a number that a row keeps from search to search, ascending."""
        return self.direction * self.surface.count + self.node

    def update(self) -> bool:
        """Bring the rows up to date; return whether they were found anew."""
        surface = self.surface
        bounding_boxes(surface.body_first, surface.position, self.lower, self.upper)
        apart = np.maximum(
            self.lower[self.slave_body] - self.upper[self.master_body],
            self.lower[self.master_body] - self.upper[self.slave_body],
        ).max(axis=1, initial=-np.inf)
        near = np.flatnonzero(apart < self.reach)
        if len(near) == 0:
            asleep = self.searched_at is None
            self.forget()
            return not asleep
        if self.searched_at is not None and np.array_equal(near, self.near):
            moved = np.abs(surface.position - self.searched_at).max()
            if moved < 0.25 * self.skin:
                return False
        self.near = near
        self._search()
        self.searched_at = surface.position.copy()
        return True

    def _search(self) -> None:
        found = [self._of_direction(int(d)) for d in self.near]
        direction, node, segment = (np.concatenate(part) for part in zip(*found, strict=True))
        starts = np.ones(len(node), dtype=bool)  # sorted by direction and node: where a new row starts
        starts[1:] = (np.diff(direction) != 0) | (np.diff(node) != 0)
        rows = np.flatnonzero(starts)
        self.direction, self.node, self.segment = direction[rows], node[rows], segment
        self.first = np.append(rows, len(node)).astype(np.int64)

    def _of_direction(self, d: int) -> tuple[IntArray, IntArray, IntArray]:
        """Direction, node and segment of all near couples, sorted by node and segment."""
        s, radius = self.surface, self.reach + self.skin
        slave, master = int(self.slave_body[d]), int(self.master_body[d])
        nodes = np.arange(s.body_first[slave], s.body_first[slave + 1])
        x = s.position[nodes]
        inside = (x > self.lower[master] - radius) & (x < self.upper[master] + radius)
        nodes = nodes[inside.all(axis=1)]
        segments = np.arange(s.body_first[master], s.body_first[master + 1])
        ends = s.position[segments], s.position[s.next[segments]]
        radius += 0.5 * float(np.linalg.norm(ends[1] - ends[0], axis=1).max())
        if len(nodes) == 0:
            empty = np.zeros(0, dtype=np.int64)
            return empty, empty, empty
        near = cKDTree(s.position[nodes]).sparse_distance_matrix(
            cKDTree(0.5 * (ends[0] + ends[1])), radius, output_type="ndarray"
        )
        order = np.lexsort((near["j"], near["i"]))
        node, segment = nodes[near["i"][order]], segments[near["j"][order]]
        return np.full(len(node), d, dtype=np.int64), node, segment
