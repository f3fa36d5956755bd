"""Facets, and boxes round facets and bodies. A facet is a segment of a closed polyline, or a triangle.

It is given by its ``corners``, one a row. In the plane the material lies on the left of the direction of
travel, so that the outward unit normal of a segment with unit tangent e_t is e_n = (e_t,y, −e_t,x); in space
the corners run counter-clockwise as seen from outside. What depends on the dimension stands in this module;
the dimension is the length of ``spacing``.
"""

from __future__ import annotations

import math

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels._struct import Struct
from mpmfw.kernels.types import Float, Floats, Ints


@device
def product_along(x: Floats, a: int, b: int, c: int, corners: Floats) -> Float:
    """(x_c − x_b)·(x − x_a) of three corners of a triangle [m²]."""
    total = 0.0
    for d in range(3):
        total += (corners[c, d] - corners[b, d]) * (x[d] - corners[a, d])
    return total


@device
def coordinates_on_triangle(x: Floats, corners: Floats, share: Floats, normal: Floats) -> Float:
    """Gap g_n of a point from the plane of a triangle [m]; the barycentric coordinates of its foot into
    ``share``. ``normal`` is e_n times twice the area on entry, e_n on return."""
    square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]
    size, gap = math.sqrt(square), 0.0
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        share[a] = 0.0
        for d in range(3):
            e, f = (d + 1) % 3, (d + 2) % 3
            share[a] += normal[d] * (
                (corners[b, e] - x[e]) * (corners[c, f] - x[f])
                - (corners[b, f] - x[f]) * (corners[c, e] - x[e])
            )
        share[a] /= square
    for d in range(3):
        normal[d] /= size
        gap += (x[d] - corners[0, d]) * normal[d]
    return gap


@device
def closest_on_triangle(x: Floats, corners: Floats, share: Floats) -> None:
    """Barycentric coordinates of the point of a triangle that is closest to x, into ``share``; those of other
    corners are exactly 0.

    Products of the edges with x − corner give the regions of the plane: those of the corners, of the
    edges, and the face (C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
    """
    # of corner i: along the edge to the second corner, and along that to the third
    to_b_a, to_c_a = product_along(x, 0, 0, 1, corners), product_along(x, 0, 0, 2, corners)
    to_b_b, to_c_b = product_along(x, 1, 0, 1, corners), product_along(x, 1, 0, 2, corners)
    to_b_c, to_c_c = product_along(x, 2, 0, 1, corners), product_along(x, 2, 0, 2, corners)
    share[0], share[1], share[2] = 0.0, 0.0, 0.0
    if to_b_a <= 0.0 and to_c_a <= 0.0:
        share[0] = 1.0
        return
    if to_b_b >= 0.0 and to_c_b <= to_b_b:
        share[1] = 1.0
        return
    if to_c_c >= 0.0 and to_b_c <= to_c_c:
        share[2] = 1.0
        return
    # signed areas of x with each edge, times twice that of the triangle
    area_c = to_b_a * to_c_b - to_b_b * to_c_a
    if area_c <= 0.0 and to_b_a >= 0.0 and to_b_b <= 0.0:
        share[1] = to_b_a / (to_b_a - to_b_b)
        share[0] = 1.0 - share[1]
        return
    area_b = to_b_c * to_c_a - to_b_a * to_c_c
    if area_b <= 0.0 and to_c_a >= 0.0 and to_c_c <= 0.0:
        share[2] = to_c_a / (to_c_a - to_c_c)
        share[0] = 1.0 - share[2]
        return
    area_a = to_b_b * to_c_c - to_b_c * to_c_b
    ahead, behind = to_c_b - to_b_b, to_b_c - to_c_c
    if area_a <= 0.0 and ahead >= 0.0 and behind >= 0.0:
        share[2] = ahead / (ahead + behind)
        share[1] = 1.0 - share[2]
        return
    total = area_a + area_b + area_c
    share[1], share[2] = area_b / total, area_c / total
    share[0] = 1.0 - share[1] - share[2]


@device
def read_corners(m: int, position: Floats, facets: Ints, corners: Floats, spacing: tuple[float, ...]) -> None:
    """Positions of the corners of facet m, into ``corners``."""
    for a in range(len(spacing)):
        for d in range(len(spacing)):
            corners[a, d] = position[facets[m, a], d]


@device
def read_point(p: int, position: Floats, x: Floats, spacing: tuple[float, ...]) -> None:
    """Position of point p, into ``x``."""
    for d in range(len(spacing)):
        x[d] = position[p, d]


@device
def area_vector(corners: Floats, out: Floats, spacing: tuple[float, ...]) -> None:
    """Outward normal of a facet times its length [m] in the plane, times twice its area [m^2] in space."""
    if len(spacing) == 2:
        out[0] = corners[1, 1] - corners[0, 1]
        out[1] = -(corners[1, 0] - corners[0, 0])
    else:
        for d in range(3):
            e, f = (d + 1) % 3, (d + 2) % 3
            out[d] = (corners[1, e] - corners[0, e]) * (corners[2, f] - corners[0, f]) - (
                corners[1, f] - corners[0, f]
            ) * (corners[2, e] - corners[0, e])


@device
def dot(a: Floats, b: Floats, spacing: tuple[float, ...]) -> Float:
    """Σ a_d b_d."""
    total = 0.0
    for d in range(len(spacing)):
        total += a[d] * b[d]
    return total


@device
def length_of(vector: Floats, spacing: tuple[float, ...]) -> Float:
    """√Σ v_d²."""
    square = 0.0
    for d in range(len(spacing)):
        square += vector[d] * vector[d]
    return math.sqrt(square)


@device
def extent_of(measure: Float, spacing: tuple[float, ...]) -> Float:
    """A length of a facet [m]: its ``measure`` [m] in the plane, the root of it [m^2] in space."""
    if len(spacing) == 2:
        return measure
    return math.sqrt(measure)


@device
def project(x: Floats, corners: Floats, share: Floats, normal: Floats, spacing: tuple[float, ...]) -> Float:
    """Gap g_n of a point from the line or the plane through a facet [m] (in the plane eq. 3, 4 of [H17]);
    the barycentric coordinates of its foot, not limited to 0 … 1, into ``share``, and e_n into ``normal``."""
    if len(spacing) == 2:
        tx, ty = corners[1, 0] - corners[0, 0], corners[1, 1] - corners[0, 1]
        length = math.sqrt(tx * tx + ty * ty)
        tx, ty = tx / length, ty / length
        x1, y1 = x[0] - corners[0, 0], x[1] - corners[0, 1]
        share[1] = (x1 * tx + y1 * ty) / length
        share[0] = 1.0 - share[1]
        normal[0], normal[1] = ty, -tx
        return x1 * ty - y1 * tx
    area_vector(corners, normal, spacing)
    return coordinates_on_triangle(x, corners, share, normal)


@device
def closest_point(x: Floats, corners: Floats, share: Floats, spacing: tuple[float, ...]) -> None:
    """Barycentric coordinates, 0 … 1, of the point of a facet that is closest to x, into ``share``."""
    if len(spacing) == 2:
        project(x, corners, share, scratch.vector(spacing), spacing)
        share[1] = min(max(share[1], 0.0), 1.0)
        share[0] = 1.0 - share[1]
    else:
        closest_on_triangle(x, corners, share)


@device
def at_rim(share: Floats, spacing: tuple[float, ...]) -> bool:
    """Return True if a point lies on an end of a segment, or on an edge of a triangle."""
    rim = False
    for a in range(len(spacing)):
        rim = rim or share[a] == 0.0
    return rim


@device
def squared_distance(x: Floats, corners: Floats, spacing: tuple[float, ...]) -> Float:
    """Squared distance of a point from a facet [m²]."""
    if len(spacing) == 2:
        tx, ty = corners[1, 0] - corners[0, 0], corners[1, 1] - corners[0, 1]
        dx, dy = x[0] - corners[0, 0], x[1] - corners[0, 1]
        xi = min(max((dx * tx + dy * ty) / (tx * tx + ty * ty), 0.0), 1.0)
        return (dx - xi * tx) ** 2 + (dy - xi * ty) ** 2
    share = scratch.vector(spacing)
    closest_on_triangle(x, corners, share)
    square = 0.0
    for d in range(3):
        away = x[d] - (share[0] * corners[0, d] + share[1] * corners[1, d] + share[2] * corners[2, d])
        square += away * away
    return square


@device
def write_gradients(
    corners: Floats, normal: Floats, scale: Float, out: Floats, spacing: tuple[float, ...]
) -> None:
    """``scale`` ∇ξ_a of every corner of a facet projected across ``normal``, (dim, dim), into ``out``; 0
    where it does not face along the normal."""
    if len(spacing) == 2:
        lever = -normal[1] * (corners[1, 0] - corners[0, 0]) + normal[0] * (corners[1, 1] - corners[0, 1])
        over = scale / lever if lever > 0.0 else 0.0
        out[1, 0], out[1, 1] = -over * normal[1], over * normal[0]
        out[0, 0], out[0, 1] = over * normal[1], -over * normal[0]
    else:
        area = scratch.vector(spacing)
        area_vector(corners, area, spacing)
        lever = dot(area, normal, spacing)
        over = scale / lever if lever > 0.0 else 0.0
        for d in range(3):
            e, f = (d + 1) % 3, (d + 2) % 3
            for a in range(3):
                b, c = (a + 1) % 3, (a + 2) % 3
                opposite = (corners[c, e] - corners[b, e]) * normal[f] - (
                    corners[c, f] - corners[b, f]
                ) * normal[e]
                out[a, d] = -over * opposite


@device
def write_own_gradients(corners: Floats, scale: Float, out: Floats, spacing: tuple[float, ...]) -> None:
    """``scale`` ∇ξ_a of every corner of a facet within its own line or plane, (dim, dim), into ``out``."""
    if len(spacing) == 2:
        tx, ty = corners[1, 0] - corners[0, 0], corners[1, 1] - corners[0, 1]
        over = scale / (tx * tx + ty * ty)
        out[0, 0], out[0, 1] = -over * tx, -over * ty
        out[1, 0], out[1, 1] = over * tx, over * ty
    else:
        area = scratch.vector(spacing)
        area_vector(corners, area, spacing)
        size = length_of(area, spacing)
        for d in range(3):
            area[d] /= size
        write_gradients(corners, area, scale, out, spacing)


class Boxes(Struct):
    """Bounding boxes of all bodies."""

    lower: Floats  #: (n_bodies, dim) [m]
    upper: Floats  #: (n_bodies, dim) [m]


@device
def read_box(
    i: int, corners: Ints, position: Floats, lower: Floats, upper: Floats, spacing: tuple[float, ...]
) -> None:
    """Write the bounding box of the surface nodes ``corners[i]`` into ``lower`` and ``upper`` (dim,) [m]."""
    for d in range(len(spacing)):
        lower[d] = upper[d] = position[corners[i, 0], d]
        for a in range(1, corners.shape[1]):
            lower[d] = min(lower[d], position[corners[i, a], d])
            upper[d] = max(upper[d], position[corners[i, a], d])


@device
def square_between(
    lower: Floats, upper: Floats, other_lower: Floats, other_upper: Floats, spacing: tuple[float, ...]
) -> Float:
    """Squared distance of two boxes [m²]."""
    square = 0.0
    for d in range(len(spacing)):
        beyond = max(lower[d] - other_upper[d], other_lower[d] - upper[d], 0.0)
        square += beyond * beyond
    return square


@device
def boxes_apart(a: int, b: int, lower: Floats, upper: Floats, reach: Float) -> bool:
    """Return true if boxes a and b of ``lower`` and ``upper`` (n, dim) are farther apart than ``reach`` [m]
    along an axis."""
    apart = False
    for d in range(lower.shape[1]):
        apart = apart or lower[a, d] - upper[b, d] > reach or lower[b, d] - upper[a, d] > reach
    return apart


@kernel
def bounding_boxes(first: Ints, position: Floats, lower: Floats, upper: Floats) -> None:
    """Bounding box of the nodes ``first[b]:first[b + 1]`` of every body b; an empty range gives an empty
    box."""
    for b in range(len(first) - 1):
        for d in range(position.shape[1]):
            low, high = math.inf, -math.inf
            for s in range(first[b], first[b + 1]):
                low = min(low, position[s, d])
                high = max(high, position[s, d])
            lower[b, d], upper[b, d] = low, high
