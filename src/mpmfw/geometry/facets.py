"""How the facets of closed surfaces hang together: segments in the plane, triangles in space."""

from __future__ import annotations

import numpy as np

from mpmfw.geometry.layout import FloatArray, IntArray


def neighbours_of(facets: IntArray) -> IntArray:
    """Facet across the side opposite each corner (n_f, dim); a ValueError if the surface is not closed."""
    n, dim = facets.shape
    corners = [[b for b in range(dim) if b != a] for a in range(dim)]
    sides = np.sort(np.concatenate([facets[:, rest] for rest in corners]), axis=1)
    order = np.lexsort(sides.T[::-1])
    ordered = sides[order]
    in_pairs = len(ordered) % 2 == 0 and (ordered[::2] == ordered[1::2]).all()
    if not in_pairs or (ordered[1:-1:2] == ordered[2::2]).all(1).any():
        raise ValueError("the surface is not closed: a side of a facet has not exactly one other facet")
    across = np.empty(n * dim, dtype=np.int64)
    across[order[::2]], across[order[1::2]] = order[1::2] % n, order[::2] % n
    return np.ascontiguousarray(across.reshape(dim, n).T)


def stars_of(facets: IntArray, n_nodes: int) -> tuple[IntArray, IntArray]:
    """Facets round every node: ``star[first[s]:first[s + 1]]``; returns ``first`` and ``star``.

    In the plane the segment that ends at the node comes before the one that starts there.
    """
    node = facets.T[::-1].ravel()
    order = np.argsort(node, kind="stable")
    first = np.searchsorted(node[order], np.arange(n_nodes + 1))
    return first.astype(np.int64), (order % len(facets)).astype(np.int64)


def measures_of(position: FloatArray, facets: IntArray) -> FloatArray:
    """Length [m] or area [m^2] of every facet (n_f,)."""
    edges = position[facets[:, 1:]] - position[facets[:, :1]]
    if facets.shape[1] == 2:
        return np.asarray(np.linalg.norm(edges[:, 0], axis=1))
    return np.asarray(0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1))


def tributaries_of(position: FloatArray, facets: IntArray) -> FloatArray:
    """Length or area that every node stands for (n_s,): of each of its facets an equal part."""
    part = measures_of(position, facets) / facets.shape[1]
    tributary = np.zeros(len(position))
    for corner in facets.T[::-1]:
        np.add.at(tributary, corner, part)
    return tributary
