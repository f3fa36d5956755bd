"""Signed distances of surface nodes from the other bodies' surfaces."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mpmfw.paraview.triangles import distances_in_space
from mpmfw.state.fields import FloatArray, IntArray

#: Pairs of a node and a segment that are measured at once.
_AT_ONCE = 1_000_000


def surface_gaps(
    surfaces: Mapping[str, tuple[FloatArray, IntArray]],
) -> dict[str, tuple[FloatArray, FloatArray | None]]:
    """Distance of every surface node from the nearest surface of another body; negative inside of it.

    Parameters
    ----------
    surfaces
        For each body the positions of its surface nodes, (s, dim) [m], and the nodes of its facets: of segments, (s, 2), where
        each starts and ends, in the order of the nodes; of triangles, (k, 3), counter-clockwise as seen from outside.

    Returns
    -------
    dict
        (s,) [m] for each body; NaN if it is the only one. Measured as ``min_gap`` is, whose value is the least
        of both bodies'. And of triangles the outward direction of that other surface there, (s, 3), None of segments or
        if there is no other.
    """
    found: dict[str, tuple[FloatArray, FloatArray | None]] = {}
    for body, (position, own) in surfaces.items():
        others = [surface for name, surface in surfaces.items() if name != body]
        if not others:
            found[body] = np.full(len(position), np.nan), None
        elif own.shape[1] == 2:
            gaps = [signed_distances(position, nodes, facets[:, 1]) for nodes, facets in others]
            found[body] = np.min(gaps, axis=0), None
        else:
            each = [distances_in_space(position, nodes, facets) for nodes, facets in others]
            gaps = [gap for gap, _ in each]
            nearest, rows = np.argmin(gaps, axis=0), np.arange(len(position))
            found[body] = np.min(gaps, axis=0), np.array([way for _, way in each])[nearest, rows]
    return found


def signed_distances(points: FloatArray, position: FloatArray, following: IntArray) -> FloatArray:
    """Signed distance of points from closed polylines, each from its nearest segment.

    Parameters
    ----------
    points
        (n, 2) [m].
    position, following
        Nodes (s, 2) [m] of the polylines, material on the left, and the next node of each.

    Returns
    -------
    ndarray
        (n,) [m], negative inside the material. Where the nearest point is a node, the sum of the two normals
        that meet there decides.
    """
    rows = max(1, _AT_ONCE // len(position))
    parts = [points[k : k + rows] for k in range(0, len(points), rows)]
    return np.concatenate([_distances(part, position, following) for part in parts])


def _distances(points: FloatArray, position: FloatArray, following: IntArray) -> FloatArray:
    along = position[following] - position
    length = np.linalg.norm(along, axis=1)
    tangent = along / length[:, None]
    offset = points[:, None, :] - position[None, :, :]
    share = np.einsum("nsd,sd->ns", offset, tangent) / length
    apart = offset - (np.clip(share, 0.0, 1.0) * length)[:, :, None] * tangent
    squared = np.einsum("nsd,nsd->ns", apart, apart)
    rows, segment = np.arange(len(points)), squared.argmin(axis=1)
    apart, share = apart[rows, segment], share[rows, segment]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    previous = np.empty_like(following)
    previous[following] = np.arange(len(following))
    before, after = normal[previous[segment]], normal[following[segment]]
    own = normal[segment]
    end = np.where((share <= 0.0)[:, None], before, np.where((share >= 1.0)[:, None], after, 0.0))
    side = np.einsum("nd,nd->n", apart, own + end)
    distance: FloatArray = np.where(side < 0.0, -1.0, 1.0) * np.sqrt(squared[rows, segment])
    return distance
