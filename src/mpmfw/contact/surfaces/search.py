"""The closest facets of every slave node that face it, among those listed near it: [H17], section 3.2.

At the corners of flush bodies the closest facet may not face the node.
"""

from __future__ import annotations

import math

from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.contact.surfaces.outline import (
    Candidates,
    body_of,
    clear,
    distance_to,
    hidden,
    node_outward,
    opposes,
    past_a_seam,
    square_of,
)
from mpmfw.contact.surfaces.tracking import THIN, add_crossings, farthest_motion, keep_inside
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.facets import extent_of, length_of, read_corners, squared_distance
from mpmfw.kernels.surfaces import area_of
from mpmfw.kernels.types import Float, Floats
from mpmfw.state.structs import Surface

#: How far, in search radii, a facet that faces the node may be from the closest point, round a corner or
#: through a thin body.
ROUND_THE_CORNER = 0.25

#: How far outside, in lengths of the closest facet, a node still counts as flush with it.
FLUSH = 0.05


@device
def facing_facet(
    s: int, outward: Floats, m: int, share: Floats, reach: Float, outline: Surface, near: NearFacets,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Return the facet nearest to a point of facet m, of the same body, that faces node s; −1 if none is
    within ``reach`` [m]. ``share`` are the point's barycentric coordinates; the first of equals counts."""
    start, corners = scratch.vector(spacing), scratch.matrix(spacing, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    for d in range(len(spacing)):
        start[d] = 0.0
        for a in range(len(spacing)):
            start[d] += share[a] * corners[a, d]
    facing, least = -1, reach * reach
    for k in range(near.first[s], near.first[s + 1]):
        n = near.facet[k]
        if body_of(n, outline) != body_of(m, outline) or hidden(n, outline.body[s], outline):
            continue
        read_corners(n, outline.position, outline.facets, corners, spacing)
        square = squared_distance(start, corners, spacing)
        nearer = square < least or (square == least and facing < 0)
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
        if not past and (not looked or seams):
            node_outward(s, body_of(m, outline), outline, outward, spacing)
            looked = True
        if not past and not opposes(outward, m, outline, spacing):
            area_of(m, outline, area, spacing)
            flush = gap <= FLUSH * extent_of(length_of(area, spacing), spacing)
            distance_to(s, m, outline, share, normal, spacing)
            reach = ROUND_THE_CORNER * radius
            m = facing_facet(s, outward, m, share, reach, outline, near, spacing) if flush else -1
            if m >= 0:
                gap = distance_to(s, m, outline, share, normal, spacing)
                past = past_a_seam(s, m, share, normal, outline, spacing)
        kept = m >= 0 and not past
        candidates.facet[s, j], candidates.gap[s, j] = m if kept else -1, gap if kept else math.inf


#: Allowance for rounding where boxes are compared with a distance: no equally close facet is lost.
ROUNDING = 1.0 + 1e-12

#: As many slots as a node has at most, unless every facet counts.
SLOTS = (0.0,) * 3


@device
def slot_for(s: int, other: int, outline: Surface, candidates: Candidates) -> int:
    """Slot of node s with a facet of body ``other``, else free, else with the farthest."""
    facet, gap, slot = candidates.facet, candidates.gap, 0
    for j in range(facet.shape[1]):
        m = facet[s, j]
        if m >= 0 and body_of(m, outline) == other:
            return j
        far, farthest = abs(gap[s, j]), abs(gap[s, slot])
        if far > farthest or (far == farthest and m > facet[s, slot]):
            slot = j
    return slot


@device
def keep_nearest(
    s: int, m: int, least: Float, radius: Float, outline: Surface, candidates: Candidates,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Keep facet m, at least ``least`` [m] away, if no other of its body is as close to node s. The first of
    equals is kept, and the nearest bodies: the order does not matter."""
    j = slot_for(s, body_of(m, outline), outline, candidates)
    kept, distance = candidates.facet[s, j], abs(candidates.gap[s, j])
    reach = min(distance * ROUNDING + (ROUNDING - 1.0) * radius, radius)
    if m == kept or least > reach or hidden(m, outline.body[s], outline):
        return
    # in space the normals of edges and corners, which signed distances take, cost more than the distance
    if len(spacing) == 3 and square_of(s, m, outline, spacing) > reach * reach * ROUNDING:
        return
    share, normal = scratch.vector(spacing), scratch.vector(spacing)
    gap = distance_to(s, m, outline, share, normal, spacing)
    if abs(gap) < radius and (abs(gap) < distance or (abs(gap) == distance and m < kept)):
        candidates.facet[s, j], candidates.gap[s, j] = m, gap


@device
def search_node(
    s: int, radius: Float, outline: Surface, near: NearFacets, candidates: Candidates,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Find the closest facets of node s; those of the last step rule out most others."""
    last, slots = scratch.integers(SLOTS), candidates.facet.shape[1]
    for j in range(slots):
        last[j] = candidates.facet[s, j]
    clear(s, candidates)
    if near.first[s] == near.first[s + 1]:
        return
    for j in range(slots):
        if last[j] >= 0:
            keep_nearest(s, last[j], 0.0, radius, outline, candidates, spacing)
    for k in range(near.first[s], near.first[s + 1]):
        m = near.facet[k]
        least = near.away[k] - near.moved[outline.body[s]] - near.moved[body_of(m, outline)]
        keep_nearest(s, m, least, radius, outline, candidates, spacing)


@kernel
def find_candidates(
    radius: float, outline: Surface, near: NearFacets, candidates: Candidates, through: Floats,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Find for every node the closest point of each other body within ``radius``, on a facet that faces it;
    and for nodes that were inside a body, or came in unseen, a facet that they are behind. Return their
    number. ``through`` (3,): how far the farthest node that went through a body is beyond it [m], and both.
    """
    count, slots, through[0] = 0, candidates.facet.shape[1], 0.0
    inside, fast = scratch.integers(SLOTS), farthest_motion(outline) >= THIN * radius
    for s in range(len(outline.body)):
        for j in range(slots):
            inside[j] = candidates.facet[s, j] if candidates.gap[s, j] < 0.0 else -1
        search_node(s, radius, outline, near, candidates, spacing)
        reorient(s, radius, outline, near, candidates, spacing)
        for j in range(slots):
            if inside[j] >= 0:
                keep_inside(s, inside[j], outline, candidates, through, spacing)
        if fast:
            add_crossings(s, outline, near, candidates, spacing)
        for j in range(slots):
            count += 1 if candidates.facet[s, j] >= 0 else 0
    return count
