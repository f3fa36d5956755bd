"""Geometry of facets: segments of closed polylines in the plane, triangles of closed surfaces in space.

A facet is given by its ``corners``, one a row. In the plane the material lies on the left of the direction of
travel, so that the outward unit normal of a segment with unit tangent e_t is e_n = (e_t,y, −e_t,x); in space
the corners run counter-clockwise as seen from outside. What depends on the dimension stands in this module;
the dimension is the length of ``spacing``."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device
from mpmfw.kernels._struct import Struct
from mpmfw.kernels.triangle import closest_on_triangle, coordinates_on_triangle
from mpmfw.kernels.types import Float, Floats, Ints


class Facets(Struct):
    """Closed surfaces as facets. Kernels take any struct that has these members, whatever else it has."""

    position: Floats  #: (n_s, dim) surface nodes [m]
    facets: Ints  #: (n_f, dim) nodes at the corners of every facet, those of a body one after the other
    neighbours: Ints  #: (n_f, dim) facet across the side that is opposite each corner
    star_first: Ints  #: (n_s + 1,) facets round node s are ``star[star_first[s]:star_first[s + 1]]``
    star: Ints  #: (n_f dim,) in the plane the segment that ends at the node, and the one that starts there


Faceted: TypeAlias = Any  #: ``Facets``, or another struct with its members


@device
def segment_coordinate(
    x: Float, y: Float, x1: Float, y1: Float, x2: Float, y2: Float
) -> tuple[Float, Float, Float, Float, Float]:
    """Project a point on the line through a segment of the plane (eq. 3, 4 of [H17]).

    Returns
    -------
    ξ (not limited to 0 … 1), normal gap g_n [m], length l [m], and the unit tangent e_t.
    """
    tx, ty = x2 - x1, y2 - y1
    length = math.sqrt(tx * tx + ty * ty)
    tx, ty = tx / length, ty / length
    xi = ((x - x1) * tx + (y - y1) * ty) / length
    gap = (x - x1) * ty - (y - y1) * tx
    return xi, gap, length, tx, ty


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
def length_of(vector: Floats, spacing: tuple[float, ...]) -> Float:
    """√Σ v_d²."""
    length = abs(vector[0])
    for d in range(1, len(spacing)):
        length = math.hypot(length, vector[d])
    return length


@device
def extent_of(measure: Float, spacing: tuple[float, ...]) -> Float:
    """A length of a facet [m]: its ``measure`` [m] in the plane, the root of it [m^2] in space."""
    if len(spacing) == 2:
        return measure
    return math.sqrt(measure)


@device
def project(x: Floats, corners: Floats, share: Floats, normal: Floats, spacing: tuple[float, ...]) -> Float:
    """Foot of a point on the line or the plane through a facet.

    Returns
    -------
    The gap g_n [m]. Barycentric coordinates, not limited to 0 … 1, are written to ``share``, and e_n to
    ``normal``."""
    if len(spacing) == 2:
        xi, gap, _, tx, ty = segment_coordinate(
            x[0], x[1], corners[0, 0], corners[0, 1], corners[1, 0], corners[1, 1]
        )
        share[0], share[1] = 1.0 - xi, xi
        normal[0], normal[1] = ty, -tx
        return gap
    area_vector(corners, normal, spacing)
    return coordinates_on_triangle(x, corners, share, normal)


@device
def closest_point(x: Floats, corners: Floats, share: Floats, spacing: tuple[float, ...]) -> None:
    """Barycentric coordinates, 0 … 1, of the point of a facet that is closest to x, into ``share``."""
    if len(spacing) == 2:
        xi, _, _, _, _ = segment_coordinate(
            x[0], x[1], corners[0, 0], corners[0, 1], corners[1, 0], corners[1, 1]
        )
        xi = min(max(xi, 0.0), 1.0)
        share[0], share[1] = 1.0 - xi, xi
    else:
        closest_on_triangle(x, corners, share)


@device
def at_rim(share: Floats, spacing: tuple[float, ...]) -> bool:
    """Whether a point of a facet lies on its rim: on an end of a segment, on an edge or a corner of a
    triangle.
    """
    rim = False
    for a in range(len(spacing)):
        if share[a] == 0.0:
            rim = True
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
def angle_at(a: int, corners: Floats, spacing: tuple[float, ...]) -> Float:
    """Angle of a triangle at its corner ``a`` [rad]; 1 of a segment: the weight of a facet's normal in that
    of its node.
    """
    if len(spacing) == 2:
        return 1.0
    b, c = (a + 1) % 3, (a + 2) % 3
    along, square, other = 0.0, 0.0, 0.0
    for d in range(3):
        u, v = corners[b, d] - corners[a, d], corners[c, d] - corners[a, d]
        along += u * v
        square += u * u
        other += v * v
    return math.atan2(math.sqrt(max(square * other - along * along, 0.0)), along)


@device
def way_across(
    so_far: Float, part: Float, a: int, start: Floats, corners: Floats, spacing: tuple[float, ...]
) -> Float:
    """Way [m] from the point ``start`` to the side of a facet that is opposite corner ``a``.

    In the plane it is measured along the polyline: ``so_far`` to this segment, and then this ``part`` of its
    length. In space it is the distance of the edge."""
    if len(spacing) == 2:
        return so_far + part * math.hypot(corners[1, 0] - corners[0, 0], corners[1, 1] - corners[0, 1])
    b, c = (a + 1) % 3, (a + 2) % 3
    along, length, square = 0.0, 0.0, 0.0
    for d in range(3):
        edge = corners[c, d] - corners[b, d]
        along += edge * (start[d] - corners[b, d])
        length += edge * edge
    share = min(max(along / length, 0.0), 1.0)
    for d in range(3):
        away = start[d] - corners[b, d] - share * (corners[c, d] - corners[b, d])
        square += away * away
    return math.sqrt(square)


@device
def add_normal(s: int, m: int, surface: Faceted, out: Floats, spacing: tuple[float, ...]) -> None:
    """Add the outward unit normal of facet m, in space times its angle at its node s, to ``out``."""
    dim = len(spacing)
    corners, area = scratch.matrix(spacing, spacing), scratch.vector(spacing)
    read_corners(m, surface.position, surface.facets, corners, spacing)
    area_vector(corners, area, spacing)
    size, weight = length_of(area, spacing), 1.0
    if dim == 3:
        for a in range(dim):
            if surface.facets[m, a] == s:
                weight = angle_at(a, corners, spacing)
    for d in range(dim):
        out[d] += weight * (area[d] / size)


@device
def node_normal(s: int, surface: Faceted, out: Floats, spacing: tuple[float, ...]) -> None:
    """Sum of the outward unit normals of a surface node's facets, in space weighted by their angles, into
    ``out``.
    """
    for d in range(len(spacing)):
        out[d] = 0.0
    for k in range(surface.star_first[s], surface.star_first[s + 1]):
        add_normal(s, surface.star[k], surface, out, spacing)


@device
def rim_normal(
    m: int, share: Floats, surface: Faceted, normal: Floats, out: Floats, spacing: tuple[float, ...]
) -> Float:
    """Pseudo-normal where the closest point lies on the rim of facet m, whose own unit ``normal`` is, into
    ``out``.

    On the side that two facets have in common it is the sum of their normals; on the corner of a triangle
    that of the node.

    Returns
    -------
    A length of a facet there [m].
    """
    dim = len(spacing)
    corners, zeros, side = scratch.matrix(spacing, spacing), 0, 0
    for a in range(dim):
        if share[a] == 0.0:
            zeros += 1
            side = a
    read_corners(surface.neighbours[m, side], surface.position, surface.facets, corners, spacing)
    area_vector(corners, out, spacing)
    square = 0.0
    for d in range(dim):
        square += out[d] * out[d]
    size = math.sqrt(square)
    if dim == 3 and zeros > 1:
        for a in range(dim):
            if share[a] != 0.0:
                node_normal(surface.facets[m, a], surface, out, spacing)
    else:
        for d in range(dim):
            out[d] = normal[d] + out[d] / size
    return extent_of(size, spacing)


@device
def signed_distance(
    x: Floats, m: int, surface: Faceted, share: Floats, normal: Floats, spacing: tuple[float, ...]
) -> Float:
    """Distance of a point from facet ``m`` of a closed surface, negative inside the material.

    Where the closest point lies on the facet's rim, the pseudo-normal there decides inside or outside, and
    nothing else (in space: J. A. Bærentzen, H. Aanæs, 2005); the direction is that of x − x_closest, along
    which an action and its reaction leave no moment.

    Returns
    -------
    Signed distance g [m]. Barycentric coordinates of the closest point are written to ``share``, and the unit
    direction e_n to ``normal``: x = x_closest + g e_n."""
    dim = len(spacing)
    corners = scratch.matrix(spacing, spacing)
    read_corners(m, surface.position, surface.facets, corners, spacing)
    gap = project(x, corners, share, normal, spacing)
    beside = False
    for a in range(dim):
        if not share[a] > 0.0:
            beside = True
    if not beside:
        return gap
    closest_point(x, corners, share, spacing)
    if not at_rim(share, spacing):
        return gap
    pseudo, away = scratch.vector(spacing), scratch.vector(spacing)
    length = rim_normal(m, share, surface, normal, pseudo, spacing)
    square, side, norm = 0.0, 0.0, 0.0
    for d in range(dim):
        foot = 0.0
        for a in range(dim):
            foot += share[a] * corners[a, d]
        away[d] = x[d] - foot
        square += away[d] * away[d]
        side += away[d] * pseudo[d]
        norm += pseudo[d] * pseudo[d]
    distance = math.sqrt(square)
    if distance < 1e-14 * length:
        norm = math.sqrt(norm)
        for d in range(dim):
            normal[d] = pseudo[d] / norm
        return 0.0
    if side < 0.0:
        for d in range(dim):
            normal[d] = -away[d] / distance
        return -distance
    for d in range(dim):
        normal[d] = away[d] / distance
    return distance


@device
def write_gradients(
    corners: Floats, normal: Floats, scale: Float, out: Floats, spacing: tuple[float, ...]
) -> None:
    """``scale`` ∇ξ_a of every corner of a facet as seen along ``normal``, (dim, dim), into ``out``.

    The gradient is that in the plane across the normal, on to which the facet is projected; none where it
    does not face along the normal."""
    if len(spacing) == 2:
        lever = -normal[1] * (corners[1, 0] - corners[0, 0]) + normal[0] * (corners[1, 1] - corners[0, 1])
        over = scale / lever if lever > 0.0 else 0.0
        out[1, 0], out[1, 1] = -over * normal[1], over * normal[0]
        out[0, 0], out[0, 1] = over * normal[1], -over * normal[0]
    else:
        area = scratch.vector(spacing)
        area_vector(corners, area, spacing)
        lever = area[0] * normal[0] + area[1] * normal[1] + area[2] * normal[2]
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
