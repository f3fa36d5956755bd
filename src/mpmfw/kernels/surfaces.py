"""Closed surfaces of facets: signed distance of a point, and its closest facet."""

from __future__ import annotations

import math

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device
from mpmfw.kernels._struct import Struct
from mpmfw.kernels.facets import (
    area_vector,
    at_rim,
    closest_point,
    dot,
    extent_of,
    length_of,
    project,
    read_corners,
    square_between,
    squared_distance,
)
from mpmfw.kernels.types import Faceted, Float, Floats, Ints

#: Distance over the length of a facet below which a point lies on it.
ROUNDING = 1e-14

#: Cosine beyond which rounding cannot turn a facet's side.
CLEAR = 1e-9


class Facets(Struct):
    """Closed surfaces as facets. Kernels take any struct that has these members, whatever else it has."""

    position: Floats  #: (n_s, dim) surface nodes [m]
    facets: Ints  #: (n_f, dim) nodes at the corners of every facet, those of a body one after the other
    neighbours: Ints  #: (n_f, dim) facet across the side that is opposite each corner
    star_first: Ints  #: (n_s + 1,) facets round node s are ``star[star_first[s]:star_first[s + 1]]``
    star: Ints  #: (n_f dim,) in the plane the segment that ends at the node, and the one that starts there


@device
def angle_at(a: int, corners: Floats, spacing: tuple[float, ...]) -> Float:
    """Angle of a triangle at its corner ``a`` [rad], 1 of a segment: the weight of its normal in that of
    the node."""
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
def area_of(m: int, surface: Faceted, out: Floats, spacing: tuple[float, ...]) -> None:
    """Outward normal of facet m times its measure, into ``out``: :func:`.facets.area_vector`."""
    corners = scratch.matrix(spacing, spacing)
    read_corners(m, surface.position, surface.facets, corners, spacing)
    area_vector(corners, out, spacing)


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
    ``out``."""
    for d in range(len(spacing)):
        out[d] = 0.0
    for k in range(surface.star_first[s], surface.star_first[s + 1]):
        add_normal(s, surface.star[k], surface, out, spacing)


@device
def side_of(s: int, vector: Floats, most: Float, surface: Faceted, spacing: tuple[float, ...]) -> int:
    """Return 1 where a ``vector`` has with all facets' normals at node s a cosine above ``most``, −1 where
    all are below −``most``, else 0: then the sum of the normals, whose angles cost more, decides."""
    area, square = scratch.vector(spacing), most * most * dot(vector, vector, spacing)
    ahead, behind = True, True
    for k in range(surface.star_first[s], surface.star_first[s + 1]):
        area_of(surface.star[k], surface, area, spacing)
        along, beyond = dot(vector, area, spacing), square * dot(area, area, spacing)
        clear = along * along > beyond
        ahead, behind = ahead and clear and along > 0.0, behind and clear and along < 0.0
    return 1 if ahead else -1 if behind else 0


@device
def rim_normal(
    m: int, share: Floats, away: Floats, distance: Float, surface: Faceted, normal: Floats, out: Floats,
    spacing: tuple[float, ...],
) -> Float:  # fmt: skip
    """Pseudo-normal at the closest point on the rim of facet m, whose own unit ``normal`` is, into ``out``; a
    length of a facet there [m].

    It is the sum of the two normals where facets share the side, at the corner of a triangle that of the
    node. Where all facets round the corner lie on one side of ``away``, of the length ``distance`` [m], it is
    that or its reverse: its sign alone matters.
    """
    dim = len(spacing)
    zeros, side = 0, 0
    for a in range(dim):
        if share[a] == 0.0:
            zeros += 1
            side = a
    area_of(surface.neighbours[m, side], surface, out, spacing)
    size = math.sqrt(dot(out, out, spacing))
    length = extent_of(size, spacing)
    if dim == 3 and zeros > 1:
        for a in range(dim):
            if share[a] != 0.0:
                corner = surface.facets[m, a]
        sign = side_of(corner, away, CLEAR, surface, spacing) if distance >= ROUNDING * length else 0
        for d in range(dim):
            out[d] = sign * away[d]
        if sign == 0:
            node_normal(corner, surface, out, spacing)
    else:
        for d in range(dim):
            out[d] = normal[d] + out[d] / size
    return length


@device
def signed_distance(
    x: Floats, m: int, surface: Faceted, share: Floats, normal: Floats, spacing: tuple[float, ...]
) -> Float:
    """Distance g of a point from facet ``m`` of a closed surface [m], negative inside the material.

    Barycentric coordinates of the closest point are written to ``share``, and the unit direction e_n to
    ``normal``: x = x_closest + g e_n, along which an action and its reaction leave no moment. On the rim
    the pseudo-normal there decides inside or outside (in space: J. A. Bærentzen, H. Aanæs, 2005).
    """
    dim = len(spacing)
    corners = scratch.matrix(spacing, spacing)
    read_corners(m, surface.position, surface.facets, corners, spacing)
    gap = project(x, corners, share, normal, spacing)
    beside = False
    for a in range(dim):
        beside = beside or not share[a] > 0.0
    if not beside:
        return gap
    closest_point(x, corners, share, spacing)
    if not at_rim(share, spacing):
        return gap
    pseudo, away = scratch.vector(spacing), scratch.vector(spacing)
    for d in range(dim):
        foot = 0.0
        for a in range(dim):
            foot += share[a] * corners[a, d]
        away[d] = x[d] - foot
    distance = math.sqrt(dot(away, away, spacing))
    length = rim_normal(m, share, away, distance, surface, normal, pseudo, spacing)
    side = dot(away, pseudo, spacing)
    if distance < ROUNDING * length:
        norm = math.sqrt(dot(pseudo, pseudo, spacing))
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


#: Consecutive facets that share a bounding box where the closest one is looked for.
BLOCK = 8


@device
def block_boxes(
    first: int, last: int, start: int, surface: Faceted, boxes: Floats, spacing: tuple[float, ...]
) -> None:
    """Bounding boxes of each ``BLOCK`` of the facets ``first:last``, lower and upper corner, into the rows
    of ``boxes`` from ``start`` on."""
    for m in range(first, last):
        row = start + (m - first) // BLOCK
        if (m - first) % BLOCK == 0:
            for d in range(len(spacing)):
                boxes[row, 0, d], boxes[row, 1, d] = math.inf, -math.inf
        for a in range(len(spacing)):
            p = surface.facets[m, a]
            for d in range(len(spacing)):
                boxes[row, 0, d] = min(boxes[row, 0, d], surface.position[p, d])
                boxes[row, 1, d] = max(boxes[row, 1, d], surface.position[p, d])


@device
def closest_facet(
    x: Floats, within: Float, guess: int, first: int, last: int, start: int, surface: Faceted, boxes: Floats,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Of the facets ``first:last`` that closest to a point, of equally close ones the first; −1 if none is
    near.

    From row ``start`` on ``boxes`` are those of the facets' blocks (``block_boxes``); ``within`` is the
    square of the distance from which on facets are of no interest [m²]. Blocks are looked through whose
    box is not farther than that, or than the closest so far; the block of ``guess`` is the first.
    """
    corners = scratch.matrix(spacing, spacing)
    nearest, closest, size = within, -1, 0.0
    for d in range(len(spacing)):
        size += x[d] * x[d]
    blocks = (last - first + BLOCK - 1) // BLOCK
    for visit in range(-1, blocks):
        block = (guess - first) // BLOCK if visit < 0 else visit
        box = square_between(x, x, boxes[start + block, 0], boxes[start + block, 1], spacing)
        # The allowances are beyond rounding: no facet is passed over that the arithmetic would find closer.
        if box > nearest * (1.0 + 1e-9) + 1e-24 * size:
            continue
        for m in range(first + block * BLOCK, min(first + (block + 1) * BLOCK, last)):
            read_corners(m, surface.position, surface.facets, corners, spacing)
            square = squared_distance(x, corners, spacing)
            if square < nearest or (square == nearest and (closest < 0 or m < closest)):
                nearest, closest = square, m
    return closest


@device
def turns_round(x: Floats, first: int, last: int, surface: Faceted) -> int:
    """How often the closed polyline of segments ``first:last`` goes round a point of the plane: once
    inside a body, whatever its corners do."""
    turns = 0
    for m in range(first, last):
        p, q = surface.facets[m, 0], surface.facets[m, 1]
        below, then = surface.position[p, 1] <= x[1], surface.position[q, 1] <= x[1]
        if below != then:
            left = (surface.position[q, 0] - surface.position[p, 0]) * (x[1] - surface.position[p, 1])
            left -= (x[0] - surface.position[p, 0]) * (surface.position[q, 1] - surface.position[p, 1])
            # A line upwards has the point on its left, or one downwards on its right
            if below and left > 0.0:
                turns += 1
            elif then and left < 0.0:
                turns -= 1
    return turns
