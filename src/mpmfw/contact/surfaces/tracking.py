"""A node inside another body is followed until it is seen to come out, however deep it is and however fast it
moved."""

from __future__ import annotations

import math
from typing import Any

from mpmfw.contact.surfaces.covering import past_a_seam
from mpmfw.contact.surfaces.outline import (
    Candidates,
    Outline,
    Partners,
    distance_to,
    dot,
    hidden,
    put,
    square_of,
)
from mpmfw.contact.surfaces.search import LEAST_COSINE, node_outward, opposition
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.boxes import Boxes, boxes_apart
from mpmfw.kernels.facets import at_rim, length_of, project
from mpmfw.kernels.types import Float, Floats

#: Least cosine between a slave node's normal and the direction out of a body by which the node has gone
#: through it: one that leaves the way it entered, or round a corner, has an angle of 90° or more, or little
#: less.
THROUGH = 0.7

#: How far beyond the far side of a body, in cells, a node may be before the bodies count as crossed.
CROSSED = 1.0


@device
def nearest_facet(s: int, first: int, last: int, outline: Outline, spacing: tuple[float, ...]) -> int:
    """Of the facets ``first:last`` the one nearest to node s; of equally near ones the first."""
    nearest, closest = math.inf, first
    for m in range(first, last):
        if hidden(m, outline.body[s], outline):
            continue
        square = square_of(s, m, outline, spacing)
        if square < nearest:
            nearest, closest = square, m
    return closest


@device
def walk(s: int, m: int, outward: Floats, outline: Outline, spacing: tuple[float, ...]) -> int:
    """Facet that is locally nearest to node s, reached from facet m along facets that face the node's normal,
    ``outward``.

    From a facet that does not, the way is free to those that face it more.
    """
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
def behind(
    s: int, m: int, outline: Outline, share: Floats, normal: Floats, spacing: tuple[float, ...]
) -> Float:
    """Gap of a node that is behind facet m, positive if it is in front after all; writes barycentric
    coordinates and e_n.

    Where the closest point is on the rim, the node is behind it whatever the pseudo-normal there says: a
    nearer facet may be round the corner.
    """
    g = distance_to(s, m, outline, share, normal, spacing)
    if g > 0.0 and at_rim(share, spacing):
        g = -g
        for d in range(len(spacing)):
            normal[d] = -normal[d]
    return g


@device
def place_of(s: int, other: int, candidates: Candidates) -> Any:
    """Slot of node s that has a candidate of body ``other``, else −1; and one for a new candidate: a free
    one, else that of the largest gap."""
    facet, gap = candidates.facet, candidates.gap
    slot, place = -1, 0
    for j in range(facet.shape[1]):
        if facet[s, j] >= 0 and candidates.master[s, j] == other:
            slot = j
        if facet[s, place] >= 0 and (facet[s, j] < 0 or gap[s, j] > gap[s, place]):
            place = j
    return slot, place


@kernel
def keep_inside(outline: Outline, candidates: Candidates, through: Floats, spacing: tuple[float, ...]) -> int:
    """Give nodes that were inside a body, and that the search has lost, the closest point of its surface that
    faces them; return the number of candidates added.

    A node that the search has lost has come out round a corner, is deeper than the search radius, or has gone
    through to the far side; only the first is let go. Of those that went through, ``through`` (3,) has how
    far the farthest is beyond the far side [m], its index, and the body's.
    """
    added = 0
    outward, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    through[0] = 0.0
    for s in range(len(outline.body)):
        for i in range(candidates.inside.shape[1]):
            other = candidates.inside[s, i]
            if other < 0:
                continue
            slot, place = place_of(s, other, candidates)
            if slot >= 0:
                continue
            m = nearest_facet(s, outline.facet_first[other], outline.facet_first[other + 1], outline, spacing)
            out = distance_to(s, m, outline, share, normal, spacing)
            if past_a_seam(s, m, share, normal, outline, spacing):
                continue
            node_outward(s, other, outline, outward, spacing)
            if length_of(outward, spacing) == 0.0:  # covered all round
                continue
            if out >= 0.0:
                if dot(outward, normal, spacing) < THROUGH * length_of(outward, spacing):
                    continue
                if out > through[0]:
                    through[0], through[1], through[2] = out, float(s), float(other)
            m = walk(s, candidates.inside_facet[s, i], outward, outline, spacing)
            g = behind(s, m, outline, share, normal, spacing)
            if g < 0.0 and not past_a_seam(s, m, share, normal, outline, spacing):
                added += 1 if candidates.facet[s, place] < 0 else 0
                put(s, place, other, m, g, share, normal, candidates, spacing)
    return added


@device
def foot_then(
    s: int, m: int, back: Float, outline: Outline, share: Floats, spacing: tuple[float, ...]
) -> Float:
    """Gap [m] of node s from facet m where they were the part ``back`` of their last displacements ago, and
    its foot's barycentric coordinates then."""
    dim, moved = len(spacing), outline.displacement
    x, corners, normal = scratch.vector(spacing), scratch.matrix(spacing, spacing), scratch.vector(spacing)
    for d in range(dim):
        x[d] = outline.position[s, d] - back * moved[s, d]
        for a in range(dim):
            p = outline.facets[m, a]
            corners[a, d] = outline.position[p, d] - back * moved[p, d]
    return project(x, corners, share, normal, spacing)


@device
def crosses(s: int, m: int, outline: Outline, spacing: tuple[float, ...]) -> bool:
    """Return true if node s came through facet m from its front in the last step; both moved evenly."""
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
def outside_body(
    s: int, b: int, reach: Float, outline: Outline, boxes: Boxes, spacing: tuple[float, ...]
) -> bool:
    """Return true if node s is farther than ``reach`` [m] from the box of body b along an axis."""
    outside = False
    for d in range(len(spacing)):
        x = outline.position[s, d]
        outside = outside or x < boxes.lower[b, d] - reach or x > boxes.upper[b, d] + reach
    return outside


@device
def add_crossing(
    s: int, other: int, outline: Outline, candidates: Candidates, spacing: tuple[float, ...]
) -> int:
    """Add the facet of body ``other`` through which node s came in the last step; return how many that are,
    0 or 1."""
    share, normal = scratch.vector(spacing), scratch.vector(spacing)
    slot, place = place_of(s, other, candidates)
    if slot >= 0 or candidates.facet[s, place] >= 0:
        return 0
    for m in range(outline.facet_first[other], outline.facet_first[other + 1]):
        if not hidden(m, outline.body[s], outline) and crosses(s, m, outline, spacing):
            g = behind(s, m, outline, share, normal, spacing)
            put(s, place, other, m, g, share, normal, candidates, spacing)
            return 1
    return 0


@kernel
def find_crossings(
    least_travel: float, outline: Outline, partners: Partners, boxes: Boxes, candidates: Candidates,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Add nodes that came in through a facet in the last step and that the search has missed: nearer to the
    far side of a thin body, or by a flank that does not face them. Return how many, 0 where no node has moved
    by ``least_travel`` [m]."""
    added, travel, body_first = 0, 0.0, outline.body_first
    for s in range(body_first[-1]):
        for d in range(len(spacing)):
            travel = max(travel, 2.0 * abs(outline.displacement[s, d]))
    if travel < 2.0 * least_travel:
        return 0
    for mine in range(len(body_first) - 1):
        for k in range(partners.first[mine], partners.first[mine + 1]):
            other = partners.body[k]
            if boxes_apart(mine, other, boxes, travel):
                continue
            for s in range(body_first[mine], body_first[mine + 1]):
                if not outside_body(s, other, travel, outline, boxes, spacing):
                    added += add_crossing(s, other, outline, candidates, spacing)
    return added


@kernel
def remember_inside(candidates: Candidates) -> None:
    """Note for the next step which nodes are inside which bodies."""
    facet = candidates.facet
    for s in range(len(facet)):
        for j in range(facet.shape[1]):
            inside = facet[s, j] >= 0 and candidates.gap[s, j] < 0.0
            candidates.inside[s, j] = candidates.master[s, j] if inside else -1
            candidates.inside_facet[s, j] = facet[s, j]
