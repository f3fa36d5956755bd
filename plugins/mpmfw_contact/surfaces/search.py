"""Search of slave nodes and master segments in three steps ([H17] section 3.2)."""

from __future__ import annotations

import math

from mpmfw.kernels import device, kernel
from mpmfw.kernels.polyline import segment_coordinate
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw_contact.surfaces.candidates import Candidates, SearchGrid, put
from mpmfw_contact.surfaces.facing import turn_to_facing
from mpmfw_contact.surfaces.outline import Outline, distance_to


@device
def boxes_apart(a: int, b: int, lower: Floats, upper: Floats, reach: Float) -> bool:
    """Whether the bounding boxes of bodies a and b are farther apart than ``reach`` [m] along an axis."""
    beyond = False
    for d in range(2):
        if lower[a, d] - upper[b, d] > reach or lower[b, d] - upper[a, d] > reach:
            beyond = True
    return beyond


@kernel
def near_boxes(first: Ints, second: Ints, reach: float, grid: SearchGrid) -> bool:
    """Box of what of each body may be within ``reach`` [m] of another, empty for most; whether there are any.

    Of pairs with boxes closer than that it is the part within the other's box, widened by the reach; of more than one the
    box round them.
    """
    near, lower, upper = False, grid.box_lower, grid.box_upper
    near_lower, near_upper = grid.near_lower, grid.near_upper
    near_lower[:] = math.inf
    near_upper[:] = -math.inf
    for c in range(len(first)):
        if boxes_apart(first[c], second[c], lower, upper, reach):
            continue
        near = True
        for way in range(2):
            a, b = (first[c], second[c]) if way == 0 else (second[c], first[c])
            for d in range(lower.shape[1]):
                near_lower[a, d] = min(near_lower[a, d], max(lower[a, d], lower[b, d] - reach))
                near_upper[a, d] = max(near_upper[a, d], min(upper[a, d], upper[b, d] + reach))
    return near


@device
def outside_near(s: int, e: int, outline: Outline, grid: SearchGrid) -> bool:
    """Whether the segment from node s to node e has nothing in its body's near box."""
    outside, b, position = False, outline.body[s], outline.position
    for d in range(2):
        low, high = min(position[s, d], position[e, d]), max(position[s, d], position[e, d])
        if high < grid.near_lower[b, d] or low > grid.near_upper[b, d]:
            outside = True
    return outside


@device
def cell_of(x: float, d: int, grid: SearchGrid, spacing: tuple[float, ...]) -> int:
    """Index along axis d of the cell that holds x, limited to the grid."""
    cell: int = min(max(math.floor((x - grid.lower[d]) / spacing[0]), 0), grid.nodes[d] - 2)
    return cell


@device
def cells_of(
    s: int, outline: Outline, grid: SearchGrid, spacing: tuple[float, ...]
) -> tuple[int, int, int, int]:
    """First and last cell along x, and along y, that the bounding box of segment s touches."""
    position, e = outline.position, outline.next[s]
    return (
        cell_of(min(position[s, 0], position[e, 0]), 0, grid, spacing),
        cell_of(max(position[s, 0], position[e, 0]), 0, grid, spacing),
        cell_of(min(position[s, 1], position[e, 1]), 1, grid, spacing),
        cell_of(max(position[s, 1], position[e, 1]), 1, grid, spacing),
    )


@kernel
def mark_shared_nodes(stamp: int, outline: Outline, grid: SearchGrid, spacing: tuple[float, ...]) -> bool:
    """Step 1: mark the grid nodes that the surfaces of two bodies reach; return whether there are any.

    Only what lies in its body's near box counts (:func:`near_boxes`). A segment reaches the nodes of all
    cells that its bounding box touches. ``owner`` holds stamp * n_bodies + body of the first to arrive.
    """
    any_shared = False
    base = stamp * (len(outline.body_first) - 1)
    for s in range(len(outline.body)):
        if outside_near(s, outline.next[s], outline, grid):
            continue
        mine = base + outline.body[s]
        i0, i1, j0, j1 = cells_of(s, outline, grid, spacing)
        for i in range(i0, i1 + 2):
            for j in range(j0, j1 + 2):
                node = i * grid.nodes[1] + j
                if grid.owner[node] < base:
                    grid.owner[node] = mine
                elif grid.owner[node] != mine:
                    grid.shared[node] = stamp
                    any_shared = True
    return any_shared


@device
def tagged(i: int, j: int, stamp: int, grid: SearchGrid) -> bool:
    """Whether a corner of cell (i, j) is shared."""
    columns = grid.nodes[1]
    node = i * columns + j
    shared_now: bool = (
        grid.shared[node] == stamp
        or grid.shared[node + 1] == stamp
        or grid.shared[node + columns] == stamp
        or grid.shared[node + columns + 1] == stamp
    )
    return shared_now


@kernel
def list_segments(stamp: int, outline: Outline, grid: SearchGrid, spacing: tuple[float, ...]) -> int:
    """Step 2: linked lists of the segments in every tagged cell; return the number of entries, stored or not."""
    count = 0
    for s in range(len(outline.next)):
        if outside_near(s, outline.next[s], outline, grid):
            continue
        i0, i1, j0, j1 = cells_of(s, outline, grid, spacing)
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                if tagged(i, j, stamp, grid):
                    if count < len(grid.link):
                        cell = i * grid.nodes[1] + j
                        grid.link[count] = grid.head[cell] if grid.head_stamp[cell] == stamp else -1
                        grid.link_segment[count] = s
                        grid.head[cell] = count
                        grid.head_stamp[cell] = stamp
                    count += 1
    return count


@device
def keep_nearest(
    s: int, m: int, other: int, gap: Float, xi: Float, e_x: Float, e_y: Float, candidates: Candidates
) -> None:
    """Keep the closest segment of each other body; of equally close ones that with the lower index.

    The force is shared by neighbours that are equally close (:func:`.assembly.equally_close`), whichever is kept.
    Where more bodies are near than there are slots, the farthest gives way, so that the order of search does not matter.
    """
    master, segment, gaps = candidates.master, candidates.segment, candidates.gap
    farthest = 0
    for j in range(master.shape[1]):
        free = segment[s, j] < 0
        if free or master[s, j] == other:
            nearer = abs(gap) < abs(gaps[s, j]) or (abs(gap) == abs(gaps[s, j]) and m < segment[s, j])
            if free or nearer:
                put(s, j, other, m, gap, xi, e_x, e_y, candidates)
            return
        worse = abs(gaps[s, j]) > abs(gaps[s, farthest])
        tie = abs(gaps[s, j]) == abs(gaps[s, farthest]) and master[s, j] > master[s, farthest]
        if worse or tie:
            farthest = j
    j = farthest
    if abs(gap) < abs(gaps[s, j]) or (abs(gap) == abs(gaps[s, j]) and other < master[s, j]):
        put(s, j, other, m, gap, xi, e_x, e_y, candidates)


#: The nine cells round a cell, the own one first: what it holds spares most of the others.
NEIGHBOURS = (4, 0, 1, 2, 3, 5, 6, 7, 8)

#: Allowance for rounding where boxes are compared with a distance, so that of equally close segments none is lost.
ROUNDING = 1.0 + 1e-12


@device
def reach_of(s: int, radius: Float, candidates: Candidates) -> Float:
    """How far a better candidate of node s may be: the radius, or the distance found if there is one slot only."""
    if candidates.segment.shape[1] == 1 and candidates.segment[s, 0] >= 0:
        return abs(candidates.gap[s, 0]) * ROUNDING
    return radius


@device
def reach_towards(s: int, other: int, radius: Float, candidates: Candidates) -> Float:
    """How far a better segment of body ``other`` may be from node s: the radius, or the distance found if there is one."""
    for j in range(candidates.segment.shape[1]):
        if candidates.segment[s, j] >= 0 and candidates.master[s, j] == other:
            return abs(candidates.gap[s, j]) * ROUNDING + (ROUNDING - 1.0) * radius
    return radius


@device
def outside_box(x: Float, y: Float, x0: Float, x1: Float, y0: Float, y1: Float, reach: Float) -> bool:
    """Whether a point is farther than ``reach`` from the box x0 … x1, y0 … y1."""
    dx = max(x0 - x, x - x1, 0.0)
    dy = max(y0 - y, y - y1, 0.0)
    outside: bool = dx * dx + dy * dy > reach * reach
    return outside


@device
def cell_too_far(
    s: int, i: int, j: int, reach: Float, outline: Outline, grid: SearchGrid, spacing: tuple[float, ...]
) -> bool:
    """Whether cell (i, j) is farther than ``reach`` from node s."""
    x, y = outline.position[s, 0], outline.position[s, 1]
    x0, y0 = grid.lower[0] + i * spacing[0], grid.lower[1] + j * spacing[1]
    return outside_box(x, y, x0, x0 + spacing[0], y0, y0 + spacing[1], reach)


@device
def too_far(s: int, m: int, reach: Float, outline: Outline) -> bool:
    """Whether the bounding box of segment m is farther than ``reach`` from node s: spares most distances."""
    position, e = outline.position, outline.next[m]
    x0, x1 = min(position[m, 0], position[e, 0]), max(position[m, 0], position[e, 0])
    y0, y1 = min(position[m, 1], position[e, 1]), max(position[m, 1], position[e, 1])
    return outside_box(position[s, 0], position[s, 1], x0, x1, y0, y1, reach)


@device
def search_cell(
    s: int, first: int, radius: Float, every: bool, outline: Outline, rank: Ints, grid: SearchGrid, candidates: Candidates
) -> None:  # fmt: skip
    """Compare node s with the segments of a cell's list, from entry ``first`` on."""
    body, entry = outline.body, first
    while entry >= 0:
        m = grid.link_segment[entry]
        entry = grid.link[entry]
        other = body[m]
        if other == body[s] or rank[body[s]] > rank[other]:
            continue
        if every:
            keep_penetrated(s, m, other, radius, outline, candidates)
        elif not too_far(s, m, reach_towards(s, other, radius, candidates), outline):
            g, xi, e_x, e_y = distance_to(s, m, outline)
            if abs(g) < radius:
                keep_nearest(s, m, other, g, xi, e_x, e_y, candidates)


@kernel
def find_pairs(
    stamp: int, radius: float, every: bool, outline: Outline, rank: Ints, grid: SearchGrid, candidates: Candidates,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Step 3: for every slave node in a tagged cell the closest point of each other body within ``radius``, on a segment
    that faces it.

    ``every`` takes instead, as [H17] writes it, every segment with g_n < 0 and 0 ≤ ξ ≤ 1 one of whose ends
    lies within the radius, up to the number of slots. Nodes of body a are slaves to segments of b if ``rank[a]`` is no
    higher than ``rank[b]``. Return the number of candidates.
    """
    count = 0
    rows, columns = grid.nodes[0], grid.nodes[1]
    candidates.segment[:] = -1
    for s in range(len(outline.body)):
        if outside_near(s, s, outline, grid):
            continue
        ci = cell_of(outline.position[s, 0], 0, grid, spacing)
        cj = cell_of(outline.position[s, 1], 1, grid, spacing)
        if not tagged(ci, cj, stamp, grid):
            continue
        for visit in range(9):
            i = ci if visit == 0 else ci - 1 + NEIGHBOURS[visit] // 3
            j = cj if visit == 0 else cj - 1 + NEIGHBOURS[visit] % 3
            if i < 0 or j < 0 or i > rows - 2 or j > columns - 2:
                continue
            cell = i * columns + j
            first = grid.head[cell] if grid.head_stamp[cell] == stamp else -1
            if first < 0 or cell_too_far(s, i, j, reach_of(s, radius, candidates), outline, grid, spacing):
                continue
            search_cell(s, first, radius, every, outline, rank, grid, candidates)
        if not every:
            turn_to_facing(s, radius, outline, candidates)
        for j in range(candidates.segment.shape[1]):
            if candidates.segment[s, j] >= 0:
                count += 1
    return count


@device
def keep_penetrated(
    s: int, m: int, other: int, radius: Float, outline: Outline, candidates: Candidates
) -> None:
    """Eq. 10: g_n < 0 and 0 ≤ ξ ≤ 1, with an end of the segment within the radius; each segment once."""
    position, e = outline.position, outline.next[m]
    x, y = position[s, 0], position[s, 1]
    near_start = (x - position[m, 0]) ** 2 + (y - position[m, 1]) ** 2 < radius * radius
    near_end = (x - position[e, 0]) ** 2 + (y - position[e, 1]) ** 2 < radius * radius
    if not (near_start or near_end):
        return
    xi, g, _, tx, ty = segment_coordinate(
        x, y, position[m, 0], position[m, 1], position[e, 0], position[e, 1]
    )
    if g >= 0.0 or xi < 0.0 or xi > 1.0:
        return
    for j in range(candidates.segment.shape[1]):
        if candidates.segment[s, j] == m:
            return
        if candidates.segment[s, j] < 0:
            put(s, j, other, m, g, xi, ty, -tx, candidates)
            return
