"""Whether parts of a surface lie within one another: every triangle has the body just below it, once."""

from __future__ import annotations

import numpy as np
import shapely

from mpmfw.geometry.layout import FloatArray, IntArray

#: A place within a triangle, in its own coordinates: through its middle a ray would meet sides of regular meshes.
PLACE = (0.2713, 0.3142, 0.4145)
#: How far below its triangle a place is looked at, over the triangle's size.
BELOW = 1e-6
#: Places that the ray finds odd of which the exact winding is asked: a ray through a side may count it twice.
ASKED = 50


def places_below(nodes: FloatArray, facets: IntArray) -> FloatArray:
    """A place (k, 3) [m] just below every triangle, on the side that its normal leaves."""
    corners = nodes[facets]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.sqrt(np.linalg.norm(normal, axis=1, keepdims=True))
    below: FloatArray = np.tensordot(corners, PLACE, axes=(1, 0)) - BELOW * normal / size
    return below


def windings(places: FloatArray, corners: FloatArray) -> IntArray:
    """How often closed surfaces of triangles (n, 3, 3) wind round places (k, 3): by rays along z, which count what they leave
    less what they enter."""
    xy = corners[:, :, :2]
    lower, upper = xy.min(axis=1), xy.max(axis=1)
    tree = shapely.STRtree(shapely.box(lower[:, 0], lower[:, 1], upper[:, 0], upper[:, 1]))
    one, met = tree.query(shapely.points(places[:, :2]))
    a, b, c = (corners[met, k] - places[one] for k in range(3))

    def twice(p: FloatArray, q: FloatArray) -> FloatArray:
        area: FloatArray = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
        return area

    shares = np.stack([twice(b, c), twice(c, a), twice(a, b)])
    area = shares.sum(axis=0)
    through = (shares * np.sign(area) >= 0.0).all(axis=0) & (area != 0.0)
    height = (shares * np.stack([a[:, 2], b[:, 2], c[:, 2]])).sum(axis=0) * np.sign(area)
    counted = through & (height > 0.0)
    return np.bincount(one[counted], np.sign(area[counted]), len(places)).astype(np.int64)


def solid_angle_winding(point: FloatArray, corners: FloatArray) -> float:
    """How often closed surfaces wind round a point: the sum of the solid angles of their triangles (n, 3, 3), over 4 π."""
    a, b, c = (corners[:, k] - point for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    sixfold = (a * np.cross(b, c)).sum(axis=1)
    below = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    return float(np.arctan2(sixfold, below).sum() / (2.0 * np.pi))


def overlapping(nodes: FloatArray, facets: IntArray) -> IntArray:
    """Numbers of triangles that have the body below them not once: within another part, or of a cavity that reaches out of the
    body; up to :data:`ASKED` of them.

    Parameters
    ----------
    nodes, facets : (n, 3), (k, 3)
        A closed surface whose parts are turned outwards, and those of cavities inwards.
    """
    corners = nodes[facets]
    places = places_below(nodes, facets)
    odd = np.flatnonzero(windings(places, corners) != 1)[:ASKED]
    found = [k for k in odd if abs(solid_angle_winding(places[k], corners) - 1.0) > 0.5]
    return np.array(found, dtype=np.int64)
