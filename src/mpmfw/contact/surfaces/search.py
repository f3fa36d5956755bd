"""The closest facets of every slave node, among those listed near it: the search of [H17], section 3.2."""

from __future__ import annotations

from mpmfw.contact.surfaces.candidates import Candidates, put
from mpmfw.contact.surfaces.facing import reorient
from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.contact.surfaces.outline import Outline, distance_to, hidden, square_of
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.facets import project, read_corners, read_point
from mpmfw.kernels.types import Float, Floats

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
    """Keep the closest facet of each other body; of equally close ones that with the lower index.

    The force is shared by neighbours that are equally close (:func:`.assembly.equally_close`), whichever is
    kept. Where more bodies are near than there are slots, the farthest gives way, so that the order of search
    does not matter.
    """
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
    s: int, radius: Float, outline: Outline, candidates: Candidates, spacing: tuple[float, ...]
) -> None:
    """Clear the slots of node s, and compare it with the facets of the last step: which is the closest does
    not depend on them, but most others are spared by what they are away."""
    last = scratch.integers(SLOTS)
    slots = candidates.facet.shape[1]
    for j in range(slots):
        last[j], candidates.facet[s, j] = candidates.facet[s, j], -1
    for j in range(slots):
        if last[j] >= 0:
            other = outline.body[outline.facets[last[j], 0]]
            search_facet(s, last[j], other, radius, outline, candidates, spacing)


@device
def keep_penetrated(
    s: int, m: int, other: int, radius: Float, outline: Outline, candidates: Candidates, spacing: tuple[float,
    ...]
) -> None:  # fmt: skip
    """Eq. 10: g_n < 0 and the foot on the facet, with a corner of it within the radius; each facet once."""
    dim = len(spacing)
    x, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    corners = scratch.matrix(spacing, spacing)
    read_point(s, outline.position, x, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    near = False
    if hidden(m, outline.body[s], outline):
        return
    for a in range(dim):
        square = 0.0
        for d in range(dim):
            square += (x[d] - corners[a, d]) ** 2
        near = near or square < radius * radius
    if not near:
        return
    gap = project(x, corners, share, normal, spacing)
    on_it = gap < 0.0
    for a in range(dim):
        on_it = on_it and share[a] >= 0.0
    if not on_it:
        return
    for j in range(candidates.facet.shape[1]):
        if candidates.facet[s, j] == m:
            return
        if candidates.facet[s, j] < 0:
            put(s, j, other, m, gap, share, normal, candidates, spacing)
            return


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
    radius: float, every: bool, outline: Outline, near: NearFacets, candidates: Candidates,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Find for every node the closest point of each other body within ``radius``, on a facet that faces it.

    ``every`` takes instead, as [H17] writes it, every facet with g_n < 0 and the foot on it one of whose
    corners lies within the radius, up to the number of slots. The facets of the last step come first: they
    spare most of the others.

    Returns
    -------
    Number of candidates; −1 − s where a corner near node s has more facets than can be looked at.
    """
    count = 0
    for s in range(len(outline.body)):
        if every or near.first[s] == near.first[s + 1]:
            for j in range(candidates.facet.shape[1]):
                candidates.facet[s, j] = -1
        else:
            begin_with_last(s, radius, outline, candidates, spacing)
        for k in range(near.first[s], near.first[s + 1]):
            m = near.facet[k]
            other = outline.body[outline.facets[m, 0]]
            if every:
                keep_penetrated(s, m, other, radius, outline, candidates, spacing)
            elif may_be_closer(s, k, other, radius, outline, near, candidates):
                search_facet(s, m, other, radius, outline, candidates, spacing)
        if not every and not reorient(s, radius, outline, candidates, spacing):
            return -1 - s
        for j in range(candidates.facet.shape[1]):
            if candidates.facet[s, j] >= 0:
                count += 1
    return count
