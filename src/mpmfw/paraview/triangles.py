"""Signed distances of points from closed surfaces of triangles."""

from __future__ import annotations

import numpy as np

from mpmfw.geometry.facets import neighbours_of
from mpmfw.state.fields import FloatArray, IntArray

#: Pairs of a point and a triangle that are measured at once.
_AT_ONCE = 500_000


def distances_in_space(
    points: FloatArray, nodes: FloatArray, facets: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Signed distance of points from a closed surface, each from its nearest triangle; negative inside the material. And the
    surface's outward direction there.

    Where the nearest point lies on an edge the sum of both normals decides, on a node the normals weighted by their angles (J. A.
    Bærentzen, H. Aanæs, 2005), as for ``min_gap``.

    Parameters
    ----------
    points : (n, 3)
        [m].
    nodes, facets : (s, 3), (k, 3)
        Of the surface [m].

    Returns
    -------
    tuple
        (n,) [m], and unit vectors (n, 3): along the distance, or the surface's pseudo-normal where there is none.
    """
    from scipy.spatial import cKDTree

    corners = nodes[facets]
    centre = corners.mean(axis=1)
    reach = float(np.linalg.norm(corners - centre[:, np.newaxis], axis=2).max())
    tree = cKDTree(centre)
    # of the triangle with the nearest centre no point is farther than that and the reach
    near, _ = tree.query(points)
    found, outward = np.empty(len(points)), np.empty_like(points)
    pseudo = _Normals(nodes, facets)
    candidates = tree.query_ball_point(points, (near + 2.0 * reach) * (1.0 + 1e-9))
    count = np.array([len(each) for each in candidates])
    ends = np.cumsum(count)
    first = 0
    while first < len(points):
        done = ends[first - 1] if first else 0
        last = max(first + 1, int(np.searchsorted(ends, done + _AT_ONCE, side="right")))
        rows = np.repeat(np.arange(first, last), count[first:last])
        facet = np.concatenate([np.asarray(each, dtype=np.int64) for each in candidates[first:last]])
        share = closest_shares(points[rows], corners[facet])
        away = points[rows] - np.einsum("na,nad->nd", share, corners[facet])
        square = (away * away).sum(axis=1)
        order = np.lexsort((facet, square, rows))
        best = order[np.searchsorted(rows[order], np.arange(first, last))]
        normal = pseudo.at(facet[best], share[best])
        sign = np.where((away[best] * normal).sum(axis=1) < 0.0, -1.0, 1.0)
        found[first:last] = sign * np.sqrt(square[best])
        on_it = square[best] <= (1e-12 * reach) ** 2
        along = np.where(on_it[:, np.newaxis], normal, sign[:, np.newaxis] * away[best])
        outward[first:last] = along / np.linalg.norm(along, axis=1, keepdims=True)
        first = last
    return found, outward


def closest_shares(points: FloatArray, corners: FloatArray) -> FloatArray:
    """Barycentric coordinates (n, 3) of the points of triangles (n, 3, 3) closest to points (n, 3); exactly 0 on rims."""
    a, b, c = (corners[:, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    square = (normal * normal).sum(axis=1)
    share = np.stack(
        [(normal * np.cross(q - p, points - p)).sum(axis=1) / square for p, q in ((b, c), (c, a), (a, b))],
        axis=1,
    )
    outside = (share <= 0.0).any(axis=1)
    best = np.full(len(points), np.inf)
    for k in range(3):  # beyond an edge the closest point is on one of the three
        i, j = (k + 1) % 3, (k + 2) % 3
        along = corners[:, j] - corners[:, i]
        t = np.clip(((points - corners[:, i]) * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
        away = points - corners[:, i] - t[:, np.newaxis] * along
        distance = (away * away).sum(axis=1)
        nearer = outside & (distance < best)
        best = np.where(nearer, distance, best)
        share[nearer, k], share[nearer, i], share[nearer, j] = 0.0, 1.0 - t[nearer], t[nearer]
    return share


class _Normals:
    """Pseudo-normals of a surface: of its triangles, edges and nodes."""

    def __init__(self, nodes: FloatArray, facets: IntArray) -> None:
        corners = nodes[facets]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self.facets, self.neighbours = facets, neighbours_of(facets)
        self.of_facet = normal / np.linalg.norm(normal, axis=1, keepdims=True)
        self.of_node = np.zeros_like(nodes)
        for a in range(3):
            u, v = (corners[:, (a + k) % 3] - corners[:, a] for k in (1, 2))
            angle = np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(axis=1))
            np.add.at(self.of_node, facets[:, a], angle[:, np.newaxis] * self.of_facet)

    def at(self, facet: IntArray, share: FloatArray) -> FloatArray:
        """Pseudo-normals (n, 3) at points of triangles (n,), given by barycentric coordinates (n, 3)."""
        zero = share == 0.0
        number = zero.sum(axis=1)
        rows = np.arange(len(facet))
        across = self.neighbours[facet, np.argmax(zero, axis=1)]
        edge = self.of_facet[facet] + self.of_facet[across]
        node = self.of_node[self.facets[facet, np.argmax(share, axis=1)]]
        normal: FloatArray = np.where((number == 1)[rows, np.newaxis], edge, self.of_facet[facet])
        return np.where((number == 2)[:, np.newaxis], node, normal)
