"""Where nodes of one surface lie to facets of others, and which facets face them ([H17], section 3.2).

At the corners of flush bodies the closest facet may not face the node.
"""

from __future__ import annotations

import math

import numpy as np

from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.kernels import Struct, device, scratch
from mpmfw.kernels.facets import (
    at_rim,
    dot,
    extent_of,
    length_of,
    read_corners,
    read_point,
    squared_distance,
)
from mpmfw.kernels.surfaces import add_normal, area_of, side_of, signed_distance
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw.state.structs import Surface


@device
def distance_to(
    s: int, m: int, outline: Surface, share: Floats, normal: Floats, spacing: tuple[float, ...]
) -> Float:
    """Signed distance of node s from facet m [m]; coordinates into ``share``, e_n into ``normal``."""
    x = scratch.vector(spacing)
    read_point(s, outline.position, x, spacing)
    return signed_distance(x, m, outline, share, normal, spacing)


@device
def square_of(s: int, m: int, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Squared distance of node s from facet m [m²]."""
    x, corners = scratch.vector(spacing), scratch.matrix(spacing, spacing)
    read_point(s, outline.position, x, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    return squared_distance(x, corners, spacing)


@device
def share_corner(s: int, m: int, n: int, square: Float, outline: Surface, spacing: tuple[float, ...]) -> bool:
    """Return true if facets m and n share a corner whose squared distance from node s is ``square`` [m²]."""
    shared = False
    for a in range(len(spacing)):
        for b in range(len(spacing)):
            p, to_corner = outline.facets[m, a], 0.0
            if p == outline.facets[n, b]:
                for d in range(len(spacing)):
                    to_corner += (outline.position[s, d] - outline.position[p, d]) ** 2
                shared = shared or to_corner == square
    return shared


@device
def body_of(m: int, outline: Surface) -> int:
    """Body of facet m."""
    body: int = outline.body[outline.facets[m, 0]]
    return body


@device
def hidden(m: int, body: int, outline: Surface) -> bool:
    """Return True if a third body covers facet m, so that ``body`` cannot touch it."""
    return len(outline.covered) > 0 and outline.covered[m] >= 0 and outline.covered[m] != body


#: What rounding leaves of lengths in cells and of cosines.
ROUNDING = 1e-9

#: Least cosine between a slave node's reversed normal and that of a facet that faces it: at the right angles
#: of blocks neither rounding nor elastic lean must decide. The sides of a wedge of 2.3° face nothing.
LEAST_COSINE = 0.02


@device
def opposition(outward: Floats, m: int, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Cosine between the reversed ``outward`` normal of a node or facet and that of facet m."""
    area = scratch.vector(spacing)
    area_of(m, outline, area, spacing)
    return -dot(outward, area, spacing) / (length_of(outward, spacing) * length_of(area, spacing))


@device
def opposes(outward: Floats, m: int, outline: Surface, spacing: tuple[float, ...]) -> bool:
    """Return true if facet m faces a node or facet with the normal ``outward``."""
    facing: bool = opposition(outward, m, outline, spacing) > LEAST_COSINE
    return facing


@device
def node_outward(s: int, other: int, outline: Surface, outward: Floats, spacing: tuple[float, ...]) -> None:
    """Normal of surface node s for body ``other``, without covered facets."""
    for d in range(len(spacing)):
        outward[d] = 0.0
    for k in range(outline.star_first[s], outline.star_first[s + 1]):
        if not hidden(outline.star[k], other, outline):
            add_normal(s, outline.star[k], outline, outward, spacing)


@device
def clearly_opposes(s: int, m: int, outline: Surface, spacing: tuple[float, ...]) -> bool:
    """Return True if in space every facet round node s faces facet m: then so does the node's normal, whose
    angles cost more."""
    if len(spacing) == 2 or len(outline.covered) > 0:
        return False
    area = scratch.vector(spacing)
    area_of(m, outline, area, spacing)
    return side_of(s, area, LEAST_COSINE * (1.0 + ROUNDING), outline, spacing) < 0


class Candidates(Struct):
    """Facets that every surface node may touch; until the search those of the last step."""

    facet: Ints  #: (n_s, slots) −1 if none is near
    gap: Floats  #: (n_s, slots) g_n [m], infinite if none is near


@device
def clear(s: int, candidates: Candidates) -> None:
    """Empty the slots of node s."""
    for j in range(candidates.facet.shape[1]):
        candidates.facet[s, j], candidates.gap[s, j] = -1, np.inf


@device
def past_a_seam(
    s: int, m: int, share: Floats, normal: Floats, outline: Surface, spacing: tuple[float, ...]
) -> bool:  # fmt: skip
    """Return True if node s is past a rim of facet m where another body's surface goes on.

    ``share`` and ``normal`` are those of :func:`distance_to`.
    """
    if len(outline.covered) == 0 or not at_rim(share, spacing):
        return False
    dim, area, ends, past = len(spacing), scratch.vector(spacing), 0, False
    area_of(m, outline, area, spacing)
    if abs(dot(area, normal, spacing)) >= (1.0 - ROUNDING) * length_of(area, spacing):
        return False
    mine, side, corner = outline.body[s], 0, 0
    for a in range(dim):
        if share[a] == 0.0:
            ends, side = ends + 1, a
        else:
            corner = a
    if ends < dim - 1:
        past = hidden(outline.neighbours[m, side], mine, outline)
    else:
        node = outline.facets[m, corner]
        for k in range(outline.star_first[node], outline.star_first[node + 1]):
            past = past or hidden(outline.star[k], mine, outline)
    return past


#: How far, in search radii, a facet that faces the node may be from the closest point, round a corner or
#: through a thin body.
ROUND_THE_CORNER = 0.25

#: How far outside, in lengths of the closest facet, a node still counts as flush with it.
FLUSH = 0.05


@device
def facing_facet(
    s: int, outward: Floats, m: int, gap: Float, share: Floats, reach: Float, outline: Surface,
    near: NearFacets, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Return the facet nearest to a point of facet m, of the same body, that faces node s; −1 if none is
    within ``reach`` [m]. ``share`` are the point's barycentric coordinates, ``gap`` [m] is its distance from
    the node; the first of equals counts."""
    start, corners = scratch.vector(spacing), scratch.matrix(spacing, spacing)
    other = body_of(m, outline)
    bound = (reach + abs(gap) + near.moved[outline.body[s]] + near.moved[other]) * (1.0 + ROUNDING)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    for d in range(len(spacing)):
        start[d] = 0.0
        for a in range(len(spacing)):
            start[d] += share[a] * corners[a, d]
    facing, least = -1, reach * reach
    for k in range(near.first[s], near.first[s + 1]):
        n = near.facet[k]
        if near.away[k] > bound or body_of(n, outline) != other or hidden(n, outline.body[s], outline):
            continue
        read_corners(n, outline.position, outline.facets, corners, spacing)
        square = squared_distance(start, corners, spacing)
        nearer = square < least or (square == least and (facing < 0 or n < facing))
        if nearer and opposes(outward, n, outline, spacing):
            facing, least = n, square
    return facing


@device
def reorient(
    s: int, radius: Float, outline: Surface, near: NearFacets, candidates: Candidates,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Replace candidates of node s that do not face it by a facet round the corner that does, or drop them.

    At the corner of flush bodies a node would be held on the other's side, and its part of the face would
    carry nothing. Nodes far outside are not turned.
    """
    outward, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    area, looked, seams = scratch.vector(spacing), False, len(outline.covered) > 0
    for j in range(candidates.facet.shape[1]):
        m, gap, past = candidates.facet[s, j], candidates.gap[s, j], False
        if m < 0:
            continue
        if seams:
            distance_to(s, m, outline, share, normal, spacing)
            past = past_a_seam(s, m, share, normal, outline, spacing)
        if past or clearly_opposes(s, m, outline, spacing):
            candidates.facet[s, j] = -1 if past else m
            candidates.gap[s, j] = math.inf if past else gap
            continue
        if not looked or seams:
            node_outward(s, body_of(m, outline), outline, outward, spacing)
            looked = True
        if not opposes(outward, m, outline, spacing):
            area_of(m, outline, area, spacing)
            if gap <= FLUSH * extent_of(length_of(area, spacing), spacing):
                distance_to(s, m, outline, share, normal, spacing)
                reach = ROUND_THE_CORNER * radius
                m = facing_facet(s, outward, m, gap, share, reach, outline, near, spacing)
            else:
                m = -1
            if m >= 0:
                gap = distance_to(s, m, outline, share, normal, spacing)
                past = past_a_seam(s, m, share, normal, outline, spacing)
        kept = m >= 0 and not past
        candidates.facet[s, j], candidates.gap[s, j] = m if kept else -1, gap if kept else math.inf
