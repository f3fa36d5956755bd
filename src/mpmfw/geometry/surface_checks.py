"""Check that triangles read from a file are the closed surface of a body."""

from __future__ import annotations

import numpy as np
import shapely

from mpmfw.geometry.layout import FloatArray, IntArray, measures_of

#: Height of a triangle over its longest side below which it has no area.
FLAT = 1e-7
#: A place within a triangle: through its middle a ray would meet sides of regular meshes.
PLACE = (0.2713, 0.3142, 0.4145)
#: How far below its triangle a place is looked at, over the triangle's size.
BELOW = 1e-6
#: Places that the ray finds odd of which the exact winding is asked: a ray through a side may count it twice.
ASKED = 50
#: A side counts as passing through a triangle this far from the rims of both, in their own coordinates.
INSIDE = 1e-7


def check_surface(nodes: FloatArray, facets: IntArray, merging: str = "") -> None:
    """Refuse a surface (n, 3) [m], (k, 3) that is open, turned inwards or crosses itself, and say where."""
    _check_areas(nodes, facets)
    _, which, count = np.unique(np.sort(facets, axis=1), axis=0, return_inverse=True, return_counts=True)
    copies = np.flatnonzero(count[which.ravel()] > 1)
    _refuse(copies, f"{np.count_nonzero(count > 1)} triangles are there more than once", nodes[facets])
    _check_sides(nodes, facets, merging)
    _check_crossings(nodes, facets)
    within = overlapping(nodes, facets)
    if len(within):
        raise ValueError(
            "parts of the surface overlap, or are turned inside out: triangles do not bound the body (facets "
            f"{_listed(within)}), the first at {_at(nodes[facets[within[0]]].mean(axis=0))}; expected parts "
            "that are apart or joined to one surface, with normals outwards, of a cavity inwards"
        )


def shells_of(facets: IntArray, n_nodes: int) -> list[IntArray]:
    """Numbers of the facets of every part of the surface that hangs together."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends = (np.repeat(facets[:, 0], 2), facets[:, 1:].ravel())
    joined = coo_array((np.ones(2 * len(facets)), ends), shape=(n_nodes, n_nodes))
    _, part = connected_components(joined, directed=False)
    of_facet = part[facets[:, 0]]
    return [np.flatnonzero(of_facet == one) for one in np.unique(of_facet)]


def _at(point: FloatArray) -> str:
    return "(" + ", ".join(f"{x:.4g}" for x in point) + ") m"


def _listed(numbers: IntArray) -> str:
    shown = ", ".join(str(k) for k in numbers[:5])
    return f"{shown}, …" if len(numbers) > 5 else shown


def _refuse(facets: IntArray, what: str, corners: FloatArray) -> None:
    if len(facets):
        place = _at(corners[facets[0]].mean(axis=0))
        raise ValueError(f"{what} (facets {_listed(facets)}), the first at {place}")


def _check_areas(nodes: FloatArray, facets: IntArray) -> None:
    corners = nodes[facets]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    flat = np.flatnonzero(2.0 * measures_of(nodes, facets) <= FLAT * sides**2)
    _refuse(flat, f"{len(flat)} triangles have no area", corners)


def _check_sides(nodes: FloatArray, facets: IntArray, merging: str) -> None:
    """Every side has one other triangle, which runs it the other way."""
    sides = np.concatenate([facets[:, [a, (a + 1) % 3]] for a in range(3)])
    facet = np.tile(np.arange(len(facets)), 3)
    pairs, which, count = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True)
    which = which.ravel()
    middle = nodes[pairs].mean(axis=1)
    for wrong, text in (
        (count == 1, "sides have a triangle on one side only: the surface has a hole"),
        (count > 2, "sides have more than two triangles"),
    ):
        if wrong.any():
            own = np.unique(facet[wrong[which]])
            raise ValueError(
                f"not closed: {np.count_nonzero(wrong)} {text}, the first at {_at(middle[wrong][0])} "
                f"(facets {_listed(own)}){merging}"
            )
    forward = np.bincount(which, weights=sides[:, 0] < sides[:, 1], minlength=len(pairs))
    alike = forward != 1.0
    if alike.any():
        own = np.unique(facet[alike[which]])
        raise ValueError(
            f"flipped triangles: both neighbours run {np.count_nonzero(alike)} sides in the same direction, "
            f"the first at {_at(middle[alike][0])} (facets {_listed(own)}); expected all counter-clockwise "
            "as seen from outside"
        )


def _check_crossings(nodes: FloatArray, facets: IntArray) -> None:
    """No side passes through another triangle."""
    corners = nodes[facets]
    lower, upper = corners.min(axis=1), corners.max(axis=1)
    boxes = shapely.box(lower[:, 0], lower[:, 1], upper[:, 0], upper[:, 1])
    one, other = shapely.STRtree(boxes).query(boxes)
    near = (one != other) & (lower[one, 2] <= upper[other, 2]) & (lower[other, 2] <= upper[one, 2])
    one, other = one[near], other[near]
    for a in range(3):
        ends = facets[one][:, [a, (a + 1) % 3]]
        apart = ~(ends[:, :, np.newaxis] == facets[other][:, np.newaxis, :]).any(axis=(1, 2))
        crossing = np.flatnonzero(apart)[_crosses(nodes[ends[apart]], corners[other[apart]])]
        if len(crossing):
            first = crossing[0]
            raise ValueError(
                f"the surface crosses itself: triangle {one[first]} goes through triangle {other[first]} at "
                f"{_at(nodes[ends[first]].mean(axis=0))}"
            )


def _crosses(ends: FloatArray, corners: FloatArray) -> FloatArray:
    """Return True where segments (n, 2, 3) cross triangles (n, 3, 3), both within their rims."""
    along = ends[:, 1] - ends[:, 0]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    away = ends[:, 0] - corners[:, 0]
    normal, moment = np.cross(u, v), np.cross(away, along)
    lever = -(along * normal).sum(axis=1)
    safe = np.where(lever == 0.0, np.inf, lever)
    share = (
        np.stack([(away * normal).sum(axis=1), (v * moment).sum(axis=1), -(u * moment).sum(axis=1)]) / safe
    )
    third = 1.0 - share[1] - share[2]
    return np.asarray((share > INSIDE).all(axis=0) & (share[0] < 1.0 - INSIDE) & (third > INSIDE))


def places_below(nodes: FloatArray, facets: IntArray) -> FloatArray:
    """A place (k, 3) [m] just below every triangle, on the side that its normal leaves."""
    corners = nodes[facets]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.sqrt(np.linalg.norm(normal, axis=1, keepdims=True))
    return np.asarray(np.tensordot(corners, PLACE, axes=(1, 0)) - BELOW * normal / size)


def windings(places: FloatArray, corners: FloatArray) -> IntArray:
    """Return how often surfaces (n, 3, 3) wind round places (k, 3), by rays along z."""
    xy = corners[:, :, :2]
    lower, upper = xy.min(axis=1), xy.max(axis=1)
    tree = shapely.STRtree(shapely.box(lower[:, 0], lower[:, 1], upper[:, 0], upper[:, 1]))
    one, met = tree.query(shapely.points(places[:, :2]))
    a, b, c = (corners[met, k] - places[one] for k in range(3))

    def twice(p: FloatArray, q: FloatArray) -> FloatArray:
        return np.asarray(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])

    shares = np.stack([twice(b, c), twice(c, a), twice(a, b)])
    area = shares.sum(axis=0)
    through = (shares * np.sign(area) >= 0.0).all(axis=0) & (area != 0.0)
    height = (shares * np.stack([a[:, 2], b[:, 2], c[:, 2]])).sum(axis=0) * np.sign(area)
    counted = through & (height > 0.0)
    return np.bincount(one[counted], np.sign(area[counted]), len(places)).astype(np.int64)


def solid_angle_winding(point: FloatArray, corners: FloatArray) -> float:
    """Return how often surfaces (n, 3, 3) wind round a point: their solid angle over 4 π."""
    a, b, c = (corners[:, k] - point for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    sixfold = (a * np.cross(b, c)).sum(axis=1)
    below = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    return float(np.arctan2(sixfold, below).sum() / (2.0 * np.pi))


def overlapping(nodes: FloatArray, facets: IntArray) -> IntArray:
    """Return up to :data:`ASKED` triangles that do not have the body below them once."""
    corners = nodes[facets]
    places = places_below(nodes, facets)
    odd = np.flatnonzero(windings(places, corners) != 1)[:ASKED]
    found = [k for k in odd if abs(solid_angle_winding(places[k], corners) - 1.0) > 0.5]
    return np.array(found, dtype=np.int64)
