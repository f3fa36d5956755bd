"""Division of triangles with long sides, each side in the same way for both of its triangles."""

from __future__ import annotations

import numpy as np

from mpmfw.geometry.layout import FloatArray, IntArray


def subdivided_triangles(nodes: FloatArray, facets: IntArray, edge: float) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 3) [m] and triangles (k, 3) of a closed surface with all sides up to ``edge`` [m].

    Sides that are longer are halved, again and again; a triangle with one, two or three of them becomes two, three or four.
    """
    while True:
        sides = np.stack([facets[:, [1, 2]], facets[:, [2, 0]], facets[:, [0, 1]]], axis=1).reshape(-1, 2)
        pairs, which = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
        length = np.linalg.norm(nodes[pairs[:, 1]] - nodes[pairs[:, 0]], axis=1)
        long = length > edge * (1.0 + 1e-12)
        if not long.any():
            return nodes, facets
        middle = np.full(len(pairs), -1)
        middle[long] = len(nodes) + np.arange(np.count_nonzero(long))
        nodes = np.concatenate([nodes, nodes[pairs[long]].mean(axis=1)])
        facets = _divided(nodes, facets, middle[which.ravel()].reshape(-1, 3))


def _divided(nodes: FloatArray, facets: IntArray, middle: IntArray) -> IntArray:
    """Triangles (k, 3) divided at the nodes in the middle of the sides opposite their corners (k, 3), −1 where there is none."""
    count = (middle >= 0).sum(axis=1)
    parts = [facets[count == 0]]
    rows = np.arange(len(facets))
    # turned so that the one side that differs from the others is opposite the first corner
    odd = np.argmax((middle >= 0) == (count == 1)[:, np.newaxis], axis=1)
    order = (odd[:, np.newaxis] + np.arange(3)) % 3
    (a, b, c), (ma, mb, mc) = (one[rows[:, np.newaxis], order].T for one in (facets, middle))
    one, two, all_three = count == 1, count == 2, count == 3
    parts += [_stacked(one, (a, b, ma)), _stacked(one, (a, ma, c))]
    # of the two diagonals the shorter
    across = np.linalg.norm(nodes[b] - nodes[mb], axis=1) <= np.linalg.norm(nodes[c] - nodes[mc], axis=1)
    parts += [_stacked(two, (a, mc, mb))]
    parts += [_stacked(two & across, (mc, b, mb)), _stacked(two & across, (b, c, mb))]
    parts += [_stacked(two & ~across, (mc, b, c)), _stacked(two & ~across, (mc, c, mb))]
    parts += [_stacked(all_three, each) for each in ((a, mc, mb), (mc, b, ma), (mb, ma, c), (ma, mb, mc))]
    return np.concatenate(parts)


def _stacked(where: IntArray, corners: tuple[IntArray, ...]) -> IntArray:
    stacked: IntArray = np.stack(corners, axis=1)[where]
    return stacked
