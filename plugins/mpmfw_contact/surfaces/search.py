"""Search of slave nodes and master facets in three steps ([H17] section 3.2)."""

from __future__ import annotations

import math

from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.facets import project, read_corners, read_point
from mpmfw.kernels.gaps import bounding_boxes
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw_contact.surfaces.candidates import Candidates, SearchGrid, put
from mpmfw_contact.surfaces.facing import turn_to_facing
from mpmfw_contact.surfaces.outline import Outline, distance_to, square_of


@device
def boxes_apart(a: int, b: int, lower: Floats, upper: Floats, reach: Float) -> bool:
    """Whether the bounding boxes of bodies a and b are farther apart than ``reach`` [m] along an axis."""
    beyond = False
    for d in range(lower.shape[1]):
        if lower[a, d] - upper[b, d] > reach or lower[b, d] - upper[a, d] > reach:
            beyond = True
    return beyond


@kernel
def near_boxes(
    first: Ints, second: Ints, reach: float, wide: float, outline: Outline, grid: SearchGrid
) -> bool:
    """Bounding boxes of all bodies, and of what of each may be within ``reach`` + ``wide`` [m] of another, empty for most;
    whether any two boxes are within ``reach``.

    Of pairs with boxes closer than both it is the part within the other's box, widened by both; of more than one the box
    round them.
    """
    near, lower, upper = False, grid.box_lower, grid.box_upper
    bounding_boxes(outline.body_first, outline.position, lower, upper)
    near_lower, near_upper = grid.near_lower, grid.near_upper
    near_lower[:] = math.inf
    near_upper[:] = -math.inf
    for c in range(len(first)):
        if boxes_apart(first[c], second[c], lower, upper, reach + wide):
            continue
        near = near or not boxes_apart(first[c], second[c], lower, upper, reach)
        for way in range(2):
            a, b = (first[c], second[c]) if way == 0 else (second[c], first[c])
            for d in range(lower.shape[1]):
                near_lower[a, d] = min(near_lower[a, d], max(lower[a, d], lower[b, d] - reach - wide))
                near_upper[a, d] = max(near_upper[a, d], min(upper[a, d], upper[b, d] + reach + wide))
    return near


@device
def reach_of_facet(
    m: int, position: Floats, facets: Ints, lower: Floats, upper: Floats, spacing: tuple[float, ...]
) -> None:
    """Bounding box of facet m, into ``lower`` and ``upper`` (dim,) [m]."""
    for d in range(len(spacing)):
        lower[d] = upper[d] = position[facets[m, 0], d]
        for a in range(1, len(spacing)):
            lower[d] = min(lower[d], position[facets[m, a], d])
            upper[d] = max(upper[d], position[facets[m, a], d])


@device
def outside_near(b: int, lower: Floats, upper: Floats, grid: SearchGrid, spacing: tuple[float, ...]) -> bool:
    """Whether the box from ``lower`` to ``upper`` has nothing in the near box of body b."""
    outside = False
    for d in range(len(spacing)):
        if upper[d] < grid.near_lower[b, d] or lower[d] > grid.near_upper[b, d]:
            outside = True
    return outside


@device
def cell_of(x: Float, d: int, grid: SearchGrid, spacing: tuple[float, ...]) -> int:
    """Index along axis d of the cell that holds x, limited to the grid."""
    cell: int = min(max(math.floor((x - grid.lower[d]) / spacing[0]), 0), grid.nodes[d] - 2)
    return cell


@device
def flat_index(index: Ints, grid: SearchGrid, spacing: tuple[float, ...]) -> int:
    """Flat index of a grid node, or of the cell whose lowest node it is."""
    flat: int = index[0]
    for d in range(1, len(spacing)):
        flat = flat * grid.nodes[d] + index[d]
    return flat


@device
def cells_of(
    lower: Floats, upper: Floats, wide: Float, first: Ints, last: Ints, grid: SearchGrid, spacing: tuple[float, ...]
) -> None:  # fmt: skip
    """First and last cell along every axis that the box from ``lower`` to ``upper`` touches, widened by ``wide`` [m]."""
    for d in range(len(spacing)):
        first[d] = cell_of(lower[d] - wide, d, grid, spacing)
        last[d] = cell_of(upper[d] + wide, d, grid, spacing)


@device
def number_of(first: Ints, last: Ints, spacing: tuple[float, ...]) -> int:
    """Number of the cells or nodes from ``first`` to ``last``."""
    number = 1
    for d in range(len(spacing)):
        number *= last[d] - first[d] + 1
    return number


@device
def advance(index: Ints, first: Ints, last: Ints, spacing: tuple[float, ...]) -> None:
    """The next of the cells or nodes from ``first`` to ``last``, the last axis fastest."""
    dim = len(spacing)
    index[dim - 1] += 1
    for back in range(1, dim):
        d = dim - back
        if index[d] > last[d]:
            index[d] = first[d]
            index[d - 1] += 1


@device
def mark_shared_nodes(
    stamp: int, wide: Float, outline: Outline, grid: SearchGrid, spacing: tuple[float, ...]
) -> bool:
    """Step 1: mark the grid nodes that the surfaces of two bodies reach; return whether there are any.

    Only what lies in its body's near box counts (:func:`near_boxes`); such facets, and their bounding boxes, are listed. A
    facet reaches the nodes of all cells that its bounding box, widened by ``wide``, touches. ``owner`` holds stamp * n_bodies +
    body of the first to arrive.
    """
    any_shared, count = False, 0
    lower, upper = scratch.vector(spacing), scratch.vector(spacing)
    first, last, index = scratch.integers(spacing), scratch.integers(spacing), scratch.integers(spacing)
    base = stamp * (len(outline.body_first) - 1)
    for m in range(len(outline.facets)):
        reach_of_facet(m, outline.position, outline.facets, lower, upper, spacing)
        body = outline.body[outline.facets[m, 0]]
        if outside_near(body, lower, upper, grid, spacing):
            continue
        grid.near[count] = m
        count += 1
        for d in range(len(spacing)):
            grid.facet_lower[m, d], grid.facet_upper[m, d] = lower[d], upper[d]
        mine = base + body
        cells_of(lower, upper, wide, first, last, grid, spacing)
        for d in range(len(spacing)):
            last[d] += 1  # nodes, of which there is one more
            index[d] = first[d]
        for _ in range(number_of(first, last, spacing)):
            node = flat_index(index, grid, spacing)
            if grid.owner[node] < base:
                grid.owner[node] = mine
            elif grid.owner[node] != mine:
                grid.shared[node] = stamp
                any_shared = True
            advance(index, first, last, spacing)
    grid.near_count[0] = count
    return any_shared


@device
def tagged(cell: int, stamp: int, grid: SearchGrid, spacing: tuple[float, ...]) -> bool:
    """Whether a corner of a cell, given by its flat index, is shared."""
    shared_now = False
    for corner in range(2 ** len(spacing)):
        step, stride = 0, 1
        for back in range(len(spacing)):
            d = len(spacing) - 1 - back
            step += (corner >> back & 1) * stride
            stride *= grid.nodes[d]
        if grid.shared[cell + step] == stamp:
            shared_now = True
            break
    return shared_now


@kernel
def list_facets(
    stamp: int, wide: float, outline: Outline, grid: SearchGrid, spacing: tuple[float, ...]
) -> int:
    """Steps 1 and 2: linked lists of the near facets in every tagged cell; return the number of entries, stored or not.

    There are none where no two bodies share a node. Facets count as larger by ``wide`` [m] all round.
    """
    count = 0
    if not mark_shared_nodes(stamp, wide, outline, grid, spacing):
        return 0
    first, last, index = scratch.integers(spacing), scratch.integers(spacing), scratch.integers(spacing)
    for k in range(grid.near_count[0]):
        m = grid.near[k]
        body = outline.body[outline.facets[m, 0]]
        cells_of(grid.facet_lower[m], grid.facet_upper[m], wide, first, last, grid, spacing)
        for d in range(len(spacing)):
            index[d] = first[d]
        for _ in range(number_of(first, last, spacing)):
            cell = flat_index(index, grid, spacing)
            if tagged(cell, stamp, grid, spacing):
                if count < len(grid.link):
                    begun = grid.head_stamp[cell] == stamp
                    grid.link[count] = grid.head[cell] if begun else -1
                    grid.link_facet[count], grid.link_body[count] = m, body
                    grid.head_body[cell] = body if not begun or grid.head_body[cell] == body else -1
                    grid.head[cell], grid.head_stamp[cell] = count, stamp
                count += 1
            advance(index, first, last, spacing)
    return count


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

    The force is shared by neighbours that are equally close (:func:`.assembly.equally_close`), whichever is kept.
    Where more bodies are near than there are slots, the farthest gives way, so that the order of search does not matter.
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


#: Allowance for rounding where boxes are compared with a distance, so that of equally close facets none is lost.
ROUNDING = 1.0 + 1e-12


@device
def reach_of(s: int, radius: Float, candidates: Candidates) -> Float:
    """How far a better candidate of node s may be: the radius, or the distance found if there is one slot only."""
    if candidates.facet.shape[1] == 1 and candidates.facet[s, 0] >= 0:
        return abs(candidates.gap[s, 0]) * ROUNDING
    return radius


@device
def reach_towards(s: int, other: int, radius: Float, candidates: Candidates) -> Float:
    """How far a better facet of body ``other`` may be from node s: the radius, or the distance found if there is one."""
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
    s: int, m: int, other: int, radius: Float, outline: Outline, candidates: Candidates, spacing: tuple[float, ...]
) -> None:  # fmt: skip
    """Keep facet m of body ``other`` if it is the closest to node s so far, and within ``radius``."""
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
    """Compare node s with the facets of a cell's list, from ``entry`` on; most are spared by their bounding boxes."""
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
    """Clear the slots of node s, and compare it with the facets of the last step: which is the closest does not depend on
    them, but most others are spared by what they are away."""
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
    """The cells round a node's own, as numbers of digits 0 … 2, one an axis: the own cell first, then by the number of axes along
    which they lie beside it."""
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


@device
def cell_beside(own: Ints, code: int, index: Ints, grid: SearchGrid, spacing: tuple[float, ...]) -> int:
    """Flat index of a cell beside the cell ``own``, −1 if it is outside of the grid; its indices into ``index``.

    ``code`` has a digit 0 … 2 for each axis, the last axis lowest.
    """
    inside = True
    for back in range(len(spacing)):
        d = len(spacing) - 1 - back
        index[d] = own[d] - 1 + code % 3
        code //= 3
        inside = inside and index[d] >= 0 and index[d] <= grid.nodes[d] - 2
    if not inside:
        return -1
    flat: int = flat_index(index, grid, spacing)
    return flat


@kernel
def find_pairs(
    stamp: int, radius: float, every: bool, outline: Outline, rank: Ints, grid: SearchGrid, candidates: Candidates,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Step 3: for every slave node in a tagged cell the closest point of each other body within ``radius``, on a facet
    that faces it.

    ``every`` takes instead, as [H17] writes it, every facet with g_n < 0 and the foot on it one of whose corners
    lies within the radius, up to the number of slots. Nodes of body a are slaves to facets of b if ``rank[a]`` is no
    higher than ``rank[b]``. The facets of the last step and the nearest cells come first: what they hold spares most of
    the others.

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
    s: int, m: int, other: int, radius: Float, outline: Outline, candidates: Candidates, spacing: tuple[float, ...]
) -> None:  # fmt: skip
    """Eq. 10: g_n < 0 and the foot on the facet, with a corner of it within the radius; each facet once."""
    dim = len(spacing)
    x, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    corners = scratch.matrix(spacing, spacing)
    read_point(s, outline.position, x, spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    near = False
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
