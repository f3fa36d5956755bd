"""Which facets of two surfaces face each other: at the corners of flush bodies the closest one may not."""

from __future__ import annotations

import math

from mpmfw.contact.surfaces.candidates import Candidates, put
from mpmfw.contact.surfaces.covering import past_a_seam
from mpmfw.contact.surfaces.outline import Outline, area_of, distance_to, dot, hidden
from mpmfw.kernels import device, scratch
from mpmfw.kernels.facets import add_normal, extent_of, length_of, read_corners, way_across
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
    """Whether every facet of node s faces facet m: then so does the node's normal, a sum of theirs with
    weights that need the angles, which cost more."""
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
def measure_of(m: int, outline: Outline, spacing: tuple[float, ...]) -> Float:
    """A length of facet m [m]."""
    area = scratch.vector(spacing)
    area_of(m, outline, area, spacing)
    return extent_of(length_of(area, spacing), spacing)


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
    """The facet nearest to a point of facet m along the surface that faces a node; −1 if none within
    ``reach`` [m], :data:`TOO_MANY` if there are more than it can look at.

    ``share`` are the point's barycentric coordinates, ``mine`` and ``outward``
    the node's body and normal. From facet to facet the nearest is looked
    at first, of equally near ones that on the side of the first corner.
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
    """Candidates of node s that do not face it give way to a facet round the corner that does, or are
    dropped; whether no corner had too many facets to look at.

    Where two bodies are flush, the node at the corner of one lies on the side of the other, with no gap: it
    would be held there, and its part of the face would carry nothing. A node that is outside is not turned:
    it may be inside of nothing but the plane of a far face.
    """
    outward, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    looked, done = False, True
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
        flush = candidates.gap[s, j] <= FLUSH * measure_of(m, outline, spacing)
        reach = ROUND_THE_CORNER * radius if flush else -1.0
        m = facing_facet(outline.body[s], outward, m, share, reach, outline, spacing)
        done = done and m != TOO_MANY
        if m < 0:
            candidates.master[s, j], candidates.facet[s, j] = -1, -1
        else:
            g = distance_to(s, m, outline, share, normal, spacing)
            if past_a_seam(s, m, share, normal, outline, spacing):
                candidates.master[s, j], candidates.facet[s, j] = -1, -1
                continue
            put(s, j, candidates.master[s, j], m, g, share, normal, candidates, spacing)
    return done
