"""The closest facets of every slave node that face it, among those listed near it: [H17], section 3.2.

At the corners of flush bodies the closest facet may not face the node.
"""

from __future__ import annotations

import math

from mpmfw.contact.surfaces.covering import past_a_seam
from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.contact.surfaces.outline import (
    Candidates,
    Outline,
    area_of,
    distance_to,
    dot,
    hidden,
    put,
    square_of,
)
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.facets import extent_of, length_of, read_corners, way_across
from mpmfw.kernels.surfaces import add_normal
from mpmfw.kernels.types import Float, Floats

#: Least cosine between a slave node's reversed normal and that of a facet that faces it: blocks have sides at
#: right angles, and neither rounding nor how little an elastic side leans must decide. A wedge of 2.3 degrees
#: has sides that face nothing.
LEAST_COSINE = 0.02


@device
def opposition(outward: Floats, m: int, outline: Outline, spacing: tuple[float, ...]) -> Float:
    """Cosine between the reversed normal of a slave node or facet, ``outward``, and the normal of facet m."""
    area = scratch.vector(spacing)
    area_of(m, outline, area, spacing)
    return -dot(outward, area, spacing) / (length_of(outward, spacing) * length_of(area, spacing))


@device
def opposes(outward: Floats, m: int, outline: Outline, spacing: tuple[float, ...]) -> bool:
    """Return true if facet m faces a node or facet with the normal ``outward``."""
    facing: bool = opposition(outward, m, outline, spacing) > LEAST_COSINE
    return facing


@device
def node_outward(s: int, other: int, outline: Outline, outward: Floats, spacing: tuple[float, ...]) -> None:
    """Normal of surface node s as body ``other`` sees it, without the facets that a third body covers, into
    ``outward``."""
    for d in range(len(spacing)):
        outward[d] = 0.0
    for k in range(outline.star_first[s], outline.star_first[s + 1]):
        if not hidden(outline.star[k], other, outline):
            add_normal(s, outline.star[k], outline, outward, spacing)


#: Cosine by which all facets of a node must face, so that their weighted sum does beyond rounding.
SURELY = 1.5 * LEAST_COSINE


@device
def surely_opposes(s: int, m: int, outline: Outline, spacing: tuple[float, ...]) -> bool:
    """Return True if every facet of node s faces facet m.

    Then so does the node's normal, a sum of theirs with weights that need the angles, which cost more."""
    area, own, sure = scratch.vector(spacing), scratch.vector(spacing), True
    area_of(m, outline, area, spacing)
    size = dot(area, area, spacing)
    for k in range(outline.star_first[s], outline.star_first[s + 1]):
        area_of(outline.star[k], outline, own, spacing)
        along, square = -dot(own, area, spacing), dot(own, own, spacing)
        sure = sure and along > 0.0 and along * along > SURELY * SURELY * square * size
    return sure


#: How far along the surface, in search radii, a facet that faces the node may be from the closest point.
ROUND_THE_CORNER = 0.25

#: How far outside, in lengths of the closest facet, a node still counts as flush with it.
FLUSH = 0.05

#: As many facets round a corner can be looked at; where there are more within reach the run ends and says so.
ROUND = (0.0,) * 64

#: Index in place of a facet's where there are more than those.
TOO_MANY = -2


@device
def facing_facet(
    mine: int,
    outward: Floats,
    m: int,
    share: Floats,
    reach: Float,
    outline: Outline,
    spacing: tuple[float, ...],
) -> int:
    """Return the facet nearest along the surface to a point of facet m that faces a node; −1 if none is
    within ``reach`` [m], :data:`TOO_MANY` if there are more than can be looked at.

    ``share`` are the point's barycentric coordinates, ``mine`` and ``outward`` the node's body and normal. Of
    equally near facets that on the side of the first corner comes first.
    """
    dim = len(spacing)
    facet, side, way = scratch.integers(ROUND), scratch.integers(ROUND), scratch.vector(ROUND)
    start, corners = scratch.vector(spacing), scratch.matrix(spacing, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    for d in range(dim):
        start[d] = 0.0
        for a in range(dim):
            start[d] += share[a] * corners[a, d]
    for a in range(dim):
        facet[a], side[a] = outline.neighbours[m, a], a
        way[a] = way_across(0.0, share[a], a, start, corners, spacing)
    count = dim
    while True:
        nearest = -1
        for k in range(count):
            if way[k] <= reach and (
                nearest < 0 or way[k] < way[nearest] or (way[k] == way[nearest] and side[k] < side[nearest])
            ):
                nearest = k
        if nearest < 0:
            return -1
        here, far, along = facet[nearest], way[nearest], side[nearest]
        if not hidden(here, mine, outline) and opposes(outward, here, outline, spacing):
            found: int = here
            return found
        way[nearest] = math.inf
        read_corners(here, outline.position, outline.facets, corners, spacing)
        for a in range(dim):
            other, known = outline.neighbours[here, a], outline.neighbours[here, a] == m
            for k in range(count):
                if facet[k] == other:
                    known = True
            if known:
                continue
            further = way_across(far, 1.0, a, start, corners, spacing)
            if count < len(ROUND):
                facet[count], side[count], way[count] = other, along, further
                count += 1
            elif further <= reach:
                return TOO_MANY


@device
def reorient(
    s: int, radius: Float, outline: Outline, candidates: Candidates, spacing: tuple[float, ...]
) -> bool:
    """Replace candidates of node s that do not face it by a facet round the corner that does, or drop them;
    return false where a corner has too many facets to look at.

    The node at the corner of a body lies on the side of another that is flush with it: there it would be
    held, and its part of the face would carry nothing. A node outside may be inside of the plane of a far
    face alone, and is not turned.
    """
    outward, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    area, looked, done = scratch.vector(spacing), False, True
    for j in range(candidates.facet.shape[1]):
        m = candidates.facet[s, j]
        if m < 0:
            continue
        for d in range(len(spacing)):
            share[d], normal[d] = candidates.share[s, j, d], candidates.normal[s, j, d]
        if past_a_seam(s, m, share, normal, outline, spacing):
            candidates.master[s, j], candidates.facet[s, j] = -1, -1
            continue
        if len(spacing) == 3 and surely_opposes(s, m, outline, spacing):
            continue
        if not looked or len(outline.covered) > 0:
            node_outward(s, candidates.master[s, j], outline, outward, spacing)
            looked = True
        if opposes(outward, m, outline, spacing):
            continue
        area_of(m, outline, area, spacing)
        flush = candidates.gap[s, j] <= FLUSH * extent_of(length_of(area, spacing), spacing)
        reach = ROUND_THE_CORNER * radius if flush else -1.0
        m = facing_facet(outline.body[s], outward, m, share, reach, outline, spacing)
        done = done and m != TOO_MANY
        if m >= 0:
            g = distance_to(s, m, outline, share, normal, spacing)
            if not past_a_seam(s, m, share, normal, outline, spacing):
                put(s, j, candidates.master[s, j], m, g, share, normal, candidates, spacing)
                continue
        candidates.master[s, j], candidates.facet[s, j] = -1, -1
    return done


#: Allowance for rounding where boxes are compared with a distance, so that of equally close facets none is
#: lost.
ROUNDING = 1.0 + 1e-12

#: As many slots as a node has at most, unless every facet counts.
SLOTS = (0.0,) * 3


@device
def keep_nearest(
    s: int,
    m: int,
    other: int,
    gap: Float,
    share: Floats,
    normal: Floats,
    candidates: Candidates,
    spacing: tuple[float, ...],
) -> None:
    """Keep the closest facet of each other body, of equally close ones that with the lower index; where more
    bodies are near than there are slots, the farthest gives way: the order of search does not matter."""
    master, facet, gaps = candidates.master, candidates.facet, candidates.gap
    farthest = 0
    for j in range(master.shape[1]):
        free = facet[s, j] < 0
        if free or master[s, j] == other:
            nearer = abs(gap) < abs(gaps[s, j]) or (abs(gap) == abs(gaps[s, j]) and m < facet[s, j])
            if free or nearer:
                put(s, j, other, m, gap, share, normal, candidates, spacing)
            return
        worse = abs(gaps[s, j]) > abs(gaps[s, farthest])
        tie = abs(gaps[s, j]) == abs(gaps[s, farthest]) and master[s, j] > master[s, farthest]
        if worse or tie:
            farthest = j
    j = farthest
    if abs(gap) < abs(gaps[s, j]) or (abs(gap) == abs(gaps[s, j]) and other < master[s, j]):
        put(s, j, other, m, gap, share, normal, candidates, spacing)


@device
def reach_towards(s: int, other: int, radius: Float, candidates: Candidates) -> Float:
    """How far a better facet of body ``other`` may be from node s: the radius, or the distance found if there
    is one."""
    for j in range(candidates.facet.shape[1]):
        if candidates.facet[s, j] >= 0 and candidates.master[s, j] == other:
            return abs(candidates.gap[s, j]) * ROUNDING + (ROUNDING - 1.0) * radius
    return radius


@device
def search_facet(
    s: int, m: int, other: int, radius: Float, outline: Outline, candidates: Candidates, spacing: tuple[float,
    ...]
) -> None:  # fmt: skip
    """Keep facet m of body ``other`` if it is the closest to node s so far, and within ``radius``."""
    if hidden(m, outline.body[s], outline):
        return
    share, normal = scratch.vector(spacing), scratch.vector(spacing)
    # in space the normals of edges and corners, which signed distances take, cost more than the distance
    if len(spacing) == 3:
        reach = reach_towards(s, other, radius, candidates)
        if square_of(s, m, outline, spacing) > reach * reach * ROUNDING:
            return
    g = distance_to(s, m, outline, share, normal, spacing)
    if abs(g) < radius:
        keep_nearest(s, m, other, g, share, normal, candidates, spacing)


@device
def begin_with_last(
    s: int, radius: Float, outline: Outline, near: NearFacets, candidates: Candidates,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Clear the slots of node s, and compare it with the facets of the last step if any is near: the result
    does not depend on them, but their distance rules out most others."""
    last = scratch.integers(SLOTS)
    slots = candidates.facet.shape[1]
    for j in range(slots):
        last[j], candidates.facet[s, j] = candidates.facet[s, j], -1
    if near.first[s] == near.first[s + 1]:
        return
    for j in range(slots):
        if last[j] >= 0:
            other = outline.body[outline.facets[last[j], 0]]
            search_facet(s, last[j], other, radius, outline, candidates, spacing)


@device
def may_be_closer(
    s: int, k: int, other: int, radius: Float, outline: Outline, near: NearFacets, candidates: Candidates
) -> bool:
    """Return true if entry k of the list of node s, a facet of body ``other``, may be closer than what was
    found."""
    for j in range(candidates.facet.shape[1]):
        if candidates.facet[s, j] == near.facet[k]:
            return False
    least = near.away[k] - near.moved[outline.body[s]] - near.moved[other]
    may: bool = least <= reach_towards(s, other, radius, candidates)
    return may


@kernel
def find_candidates(
    radius: float, outline: Outline, near: NearFacets, candidates: Candidates, spacing: tuple[float, ...]
) -> int:
    """Find for every node the closest point of each other body within ``radius``, on a facet that faces it;
    return how many, or −1 − s where a corner near node s has more facets than can be looked at."""
    count = 0
    for s in range(len(outline.body)):
        begin_with_last(s, radius, outline, near, candidates, spacing)
        for k in range(near.first[s], near.first[s + 1]):
            m = near.facet[k]
            other = outline.body[outline.facets[m, 0]]
            if may_be_closer(s, k, other, radius, outline, near, candidates):
                search_facet(s, m, other, radius, outline, candidates, spacing)
        if not reorient(s, radius, outline, candidates, spacing):
            return -1 - s
        for j in range(candidates.facet.shape[1]):
            if candidates.facet[s, j] >= 0:
                count += 1
    return count
