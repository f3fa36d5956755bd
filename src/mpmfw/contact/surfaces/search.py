"""The closest facets of every slave node, among those listed near it: [H17], section 3.2; and of nodes inside
other bodies, which are followed until they come out, however deep and fast."""

from __future__ import annotations

import math

from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.contact.surfaces.outline import (
    LEAST_COSINE,
    Candidates,
    body_of,
    clear,
    distance_to,
    hidden,
    node_outward,
    opposition,
    past_a_seam,
    reorient,
    share_corner,
    square_of,
)
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.facets import at_rim, dot, length_of, project
from mpmfw.kernels.types import Float, Floats
from mpmfw.state.structs import Surface

#: Ratio of distances up to which facets count as equally close, whatever rounding makes of them.
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
) -> Float:  # fmt: skip
    """Keep facet m, at least ``least`` [m] away, if no other of its body is as close to node s; return the
    distance beyond which none can be [m]. The first of equals is kept, and the nearest bodies: the order does
    not matter."""
    j = slot_for(s, body_of(m, outline), outline, candidates)
    kept, distance = candidates.facet[s, j], abs(candidates.gap[s, j])
    reach = min(distance * ROUNDING + (ROUNDING - 1.0) * radius, radius)
    if m == kept or least > reach or hidden(m, outline.body[s], outline):
        return reach
    if len(spacing) == 3:
        # in space the normals of edges and corners, which signed distances take, cost more than the distance
        square = square_of(s, m, outline, spacing)
        if square > reach * reach * ROUNDING:
            return reach
        if math.sqrt(square) == distance and share_corner(s, m, kept, square, outline, spacing):
            candidates.facet[s, j] = min(m, kept)  # both have the same closest point
            return reach
    share, normal = scratch.vector(spacing), scratch.vector(spacing)
    gap = distance_to(s, m, outline, share, normal, spacing)
    nearly = abs(gap) * ROUNDING + (ROUNDING - 1.0) * radius
    if abs(gap) < radius and (nearly < distance or (abs(gap) <= reach and m < kept)):
        candidates.facet[s, j], candidates.gap[s, j] = m, gap
        reach = min(nearly, reach)
    return reach


@device
def first_guess(s: int, near: NearFacets) -> int:
    """Return the facet whose box was nearest to node s when it was listed."""
    begin, end = near.first[s], near.first[s + 1]
    return int(near.facet[begin + near.away[begin:end].argmin()])


@device
def search_node(
    s: int, radius: Float, outline: Surface, near: NearFacets, candidates: Candidates,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Find the closest facets of node s; those of the last step, or a guess, rule out most others."""
    last, slots = scratch.integers(SLOTS), candidates.facet.shape[1]
    for j in range(slots):
        last[j] = candidates.facet[s, j]
    clear(s, candidates)
    if near.first[s] == near.first[s + 1]:
        return
    if last[0] < 0:
        last[0] = first_guess(s, near)
    for j in range(slots):
        if last[j] >= 0:
            keep_nearest(s, last[j], 0.0, radius, outline, candidates, spacing)
    bound, end = 0.0, 0  # facets of the present body end there
    for k in range(near.first[s], near.first[s + 1]):
        m = near.facet[k]
        if m < end and near.away[k] > bound:
            continue
        other = body_of(m, outline)
        motion, end = near.moved[outline.body[s]] + near.moved[other], outline.facet_first[other + 1]
        bound = motion + keep_nearest(s, m, near.away[k] - motion, radius, outline, candidates, spacing)


#: Least cosine between a slave node's normal and the direction out of a body by which the node has gone
#: through it: one that leaves as it came, or round a corner, has 90° or more, or little less.
THROUGH = 0.7

#: How far beyond the far side of a body, in cells, a node may be: then they have crossed.
CROSSED = 1.0

#: Motion in a step, in search radii, below which no node can pass the middle of a body unseen.
THIN = 0.05


@device
def nearest_facet(s: int, other: int, outline: Surface, near: NearFacets, spacing: tuple[float, ...]) -> int:
    """Of the facets of a body the one nearest to node s; of equally near ones the first. Of the node's own
    body only those of another part count, which are listed near it; −1 if there are none."""
    listed = other == outline.body[s]
    nearest, closest = math.inf, -1
    first = near.first[s] if listed else outline.facet_first[other]
    last = near.first[s + 1] if listed else outline.facet_first[other + 1]
    for k in range(first, last):
        m = near.facet[k] if listed else k
        if body_of(m, outline) != other or hidden(m, outline.body[s], outline):
            continue
        square = square_of(s, m, outline, spacing)
        if square < nearest:
            nearest, closest = square, m
    return closest


@device
def walk(s: int, m: int, outward: Floats, outline: Surface, spacing: tuple[float, ...]) -> int:
    """Walk from facet m to the locally nearest one that faces node s, or faces it more."""
    least = square_of(s, m, outline, spacing)
    for _ in range(len(outline.facets)):
        bound = min(opposition(outward, m, outline, spacing), LEAST_COSINE)
        nearer = -1
        for a in range(len(spacing)):
            n = outline.neighbours[m, a]
            square = square_of(s, n, outline, spacing)
            if hidden(n, outline.body[s], outline):
                continue
            if square < least and opposition(outward, n, outline, spacing) >= bound:
                nearer, least = n, square
        if nearer < 0:
            break
        m = nearer
    return m


@device
def slot_for_lost(s: int, other: int, outline: Surface, candidates: Candidates) -> int:
    """Slot of node s with the widest gap; −1 if one has a facet of body ``other``."""
    facet, gap, slot = candidates.facet, candidates.gap, 0
    for j in range(facet.shape[1]):
        if facet[s, j] >= 0 and body_of(facet[s, j], outline) == other:
            return -1
        if gap[s, j] > gap[s, slot]:
            slot = j
    return slot


@device
def put_behind(
    s: int, j: int, m: int, outline: Surface, candidates: Candidates, spacing: tuple[float, ...]
) -> None:
    """Put facet m into slot j of node s, unless the node is in front of it. On the rim it is behind whatever
    the pseudo-normal says: a nearer facet may be round the corner."""
    share, normal = scratch.vector(spacing), scratch.vector(spacing)
    gap = distance_to(s, m, outline, share, normal, spacing)
    if at_rim(share, spacing):
        gap = -abs(gap)
    if gap < 0.0 and not past_a_seam(s, m, share, normal, outline, spacing):
        candidates.facet[s, j], candidates.gap[s, j] = m, gap


@device
def keep_inside(
    s: int, last: int, outline: Surface, near: NearFacets, candidates: Candidates, through: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Give node s, which was behind facet ``last`` of a body, the closest facet of it that faces the node, if
    the search has found none.

    A node that the search lost came out round a corner, is deeper than the radius, or went through; only the
    first is let go. ``through`` is that of :func:`find_candidates`.
    """
    outward, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    other = body_of(last, outline)
    slot = slot_for_lost(s, other, outline, candidates)
    m = nearest_facet(s, other, outline, near, spacing) if slot >= 0 else -1
    if m < 0:
        return
    beyond = distance_to(s, m, outline, share, normal, spacing)
    if past_a_seam(s, m, share, normal, outline, spacing):
        return
    node_outward(s, other, outline, outward, spacing)
    size = length_of(outward, spacing)
    if size == 0.0 or (beyond >= 0.0 and dot(outward, normal, spacing) < THROUGH * size):
        return  # covered all round, or round a corner
    if beyond > through[0]:
        through[0], through[1], through[2] = beyond, float(s), float(other)
    put_behind(s, slot, walk(s, last, outward, outline, spacing), outline, candidates, spacing)


@device
def foot_then(
    s: int, m: int, back: Float, outline: Surface, share: Floats, spacing: tuple[float, ...]
) -> Float:
    """Gap [m] of node s from facet m, and its foot, the part ``back`` of a step ago."""
    dim, moved = len(spacing), outline.displacement
    x, corners, normal = scratch.vector(spacing), scratch.matrix(spacing, spacing), scratch.vector(spacing)
    for d in range(dim):
        x[d] = outline.position[s, d] - back * moved[s, d]
        for a in range(dim):
            p = outline.facets[m, a]
            corners[a, d] = outline.position[p, d] - back * moved[p, d]
    return project(x, corners, share, normal, spacing)


@device
def crosses(s: int, m: int, outline: Surface, spacing: tuple[float, ...]) -> bool:
    """Return true if node s came through facet m from its front in the last step."""
    share = scratch.vector(spacing)
    now = foot_then(s, m, 0.0, outline, share, spacing)
    if now >= 0.0:
        return False
    before = foot_then(s, m, 1.0, outline, share, spacing)
    if before < 0.0:
        return False
    foot_then(s, m, -now / (before - now), outline, share, spacing)  # at the crossing
    through = True
    for a in range(len(spacing)):
        through = through and share[a] >= 0.0
    return through


@device
def farthest_motion(outline: Surface) -> Float:
    """Largest displacement of any node along any axis in the last step [m]."""
    farthest = 0.0
    for s in range(len(outline.body)):
        for d in range(outline.displacement.shape[1]):
            farthest = max(farthest, abs(outline.displacement[s, d]))
    return farthest


@device
def add_crossings(
    s: int, outline: Surface, near: NearFacets, candidates: Candidates, spacing: tuple[float, ...]
) -> None:
    """Add facets through which node s came in the last step, if the search missed it; of a body the first."""
    added, slot = -1, -1
    for k in range(near.first[s], near.first[s + 1]):
        m = near.facet[k]
        if hidden(m, outline.body[s], outline) or not crosses(s, m, outline, spacing):
            continue
        if added < 0 or body_of(added, outline) != body_of(m, outline):
            slot, added = slot_for_lost(s, body_of(m, outline), outline, candidates), -1
        if slot >= 0 and (candidates.facet[s, slot] < 0 or m < added):
            put_behind(s, slot, m, outline, candidates, spacing)
            added = candidates.facet[s, slot]


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
                keep_inside(s, inside[j], outline, near, candidates, through, spacing)
        if fast:
            add_crossings(s, outline, near, candidates, spacing)
        for j in range(slots):
            count += 1 if candidates.facet[s, j] >= 0 else 0
    return count
