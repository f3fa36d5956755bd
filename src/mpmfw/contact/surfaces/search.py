"""The closest facets of every slave node, among those in the cells round it: step 3 of the search ([H17]
section 3.2)."""

from __future__ import annotations

from mpmfw.contact.surfaces.candidates import Candidates, SearchGrid, put
from mpmfw.contact.surfaces.cells import cell_beside, cell_of, flat_index, outside_near, tagged
from mpmfw.contact.surfaces.facing import turn_to_facing
from mpmfw.contact.surfaces.outline import Outline, distance_to, hidden, square_of
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.facets import project, read_corners, read_point
from mpmfw.kernels.types import Float, Floats, Ints


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


#: Allowance for rounding where boxes are compared with a distance, so that of equally close facets none is
#: lost.
ROUNDING = 1.0 + 1e-12


@device
def reach_of(s: int, radius: Float, candidates: Candidates) -> Float:
    """How far a better candidate of node s may be: the radius, or the distance found if there is one slot
    only."""
    if candidates.facet.shape[1] == 1 and candidates.facet[s, 0] >= 0:
        return abs(candidates.gap[s, 0]) * ROUNDING
    return radius


@device
def reach_towards(s: int, other: int, radius: Float, candidates: Candidates) -> Float:
    """How far a better facet of body ``other`` may be from node s: the radius, or the distance found if there
    is one."""
    for j in range(candidates.facet.shape[1]):
        if candidates.facet[s, j] >= 0 and candidates.master[s, j] == other:
            return abs(candidates.gap[s, j]) * ROUNDING + (ROUNDING - 1.0) * radius
    return radius


@device
def listed(s: int, m: int, candidates: Candidates) -> bool:
    """Whether facet m is a candidate of node s already."""
    known = False
    for j in range(candidates.facet.shape[1]):
        if candidates.facet[s, j] == m:
            known = True
    return known


@device
def outside_box(x: Floats, lower: Floats, upper: Floats, reach: Float, spacing: tuple[float, ...]) -> bool:
    """Whether a point is farther than ``reach`` from the box from ``lower`` to ``upper``."""
    square = 0.0
    for d in range(len(spacing)):
        beyond = max(lower[d] - x[d], x[d] - upper[d], 0.0)
        square += beyond * beyond
    outside: bool = square > reach * reach
    return outside


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
def search_cell(
    s: int, entry: int, radius: float, every: bool, outline: Outline, rank: Ints, grid: SearchGrid,
    candidates: Candidates, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Compare node s with the facets of a cell's list, from ``entry`` on; most are spared by their bounding
    boxes."""
    x = scratch.vector(spacing)
    read_point(s, outline.position, x, spacing)
    mine = outline.body[s]
    while entry >= 0:
        m, other = grid.link_facet[entry], grid.link_body[entry]
        entry = grid.link[entry]
        if other == mine or rank[mine] > rank[other]:
            continue
        if every:
            keep_penetrated(s, m, other, radius, outline, candidates, spacing)
            continue
        if listed(s, m, candidates):  # a facet is in the lists of all cells that its box touches
            continue
        reach = reach_towards(s, other, radius, candidates)
        if not outside_box(x, grid.facet_lower[m], grid.facet_upper[m], reach, spacing):
            search_facet(s, m, other, radius, outline, candidates, spacing)


#: As many slots as a node has at most, but where every facet counts.
SLOTS = (0.0,) * 3


@device
def begin_with_last(
    s: int, radius: float, outline: Outline, rank: Ints, candidates: Candidates, spacing: tuple[float, ...]
) -> None:  # fmt: skip
    """Clear the slots of node s, and compare it with the facets of the last step: which is the closest does
    not depend on them, but most others are spared by what they are away."""
    last = scratch.integers(SLOTS)
    slots, mine = candidates.facet.shape[1], outline.body[s]
    for j in range(slots):
        last[j], candidates.facet[s, j] = candidates.facet[s, j], -1
    for j in range(slots):
        if last[j] >= 0:
            other = outline.body[outline.facets[last[j], 0]]
            if other != mine and rank[mine] <= rank[other]:
                search_facet(s, last[j], other, radius, outline, candidates, spacing)


#: As many cells as a node's own and those round it, at most.
AROUND = (0.0,) * 27


@device
def nearest_first(order: Ints, spacing: tuple[float, ...]) -> None:
    """The cells round a node's own, as numbers of digits 0 … 2, one an axis: the own cell first, then by the
    number of axes along which they lie beside it."""
    count = 0
    for far in range(len(spacing) + 1):
        for visit in range(3 ** len(spacing)):
            code, away = visit, 0
            for _ in range(len(spacing)):
                away += (code % 3 - 1) ** 2
                code //= 3
            if away == far:
                order[count] = visit
                count += 1


@kernel
def find_pairs(
    stamp: int, radius: float, every: bool, outline: Outline, rank: Ints, grid: SearchGrid,
    candidates: Candidates,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Step 3: for every slave node in a tagged cell the closest point of each other body within ``radius``,
    on a facet that faces it.

    ``every`` takes instead, as [H17] writes it, every facet with g_n < 0 and the foot on it one of whose
    corners lies within the radius, up to the number of slots. Nodes of body a are slaves to facets of b if
    ``rank[a]`` is no higher than ``rank[b]``. The facets of the last step and the nearest cells come first:
    what they hold spares most of the others.

    Returns
    -------
    Number of candidates; −1 − s where a corner near node s has more facets than can be looked at.
    """
    dim, count = len(spacing), 0
    x, lower, upper = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    own, index = scratch.integers(spacing), scratch.integers(spacing)
    around, order = 3**dim, scratch.integers(AROUND)
    nearest_first(order, spacing)
    for s in range(len(outline.body)):
        read_point(s, outline.position, x, spacing)
        near = not outside_near(outline.body[s], x, x, grid, spacing)
        if near:
            for d in range(dim):
                own[d] = cell_of(x[d], d, grid, spacing)
            near = tagged(flat_index(own, grid, spacing), stamp, grid, spacing)
        if every or not near:
            for j in range(candidates.facet.shape[1]):
                candidates.facet[s, j] = -1
        else:
            begin_with_last(s, radius, outline, rank, candidates, spacing)
        if not near:
            continue
        for visit in range(around):
            cell = cell_beside(own, order[visit], index, grid, spacing)
            if cell < 0 or grid.head_stamp[cell] != stamp or grid.head_body[cell] == outline.body[s]:
                continue
            for d in range(dim):
                lower[d] = grid.lower[d] + index[d] * spacing[0]
                upper[d] = lower[d] + spacing[0]
            if outside_box(x, lower, upper, reach_of(s, radius, candidates), spacing):
                continue
            search_cell(s, grid.head[cell], radius, every, outline, rank, grid, candidates, spacing)
        if not every and not turn_to_facing(s, radius, outline, candidates, spacing):
            return -1 - s
        for j in range(candidates.facet.shape[1]):
            if candidates.facet[s, j] >= 0:
                count += 1
    return count


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
