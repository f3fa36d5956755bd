"""Search of slave nodes and master segments in three steps ([H17] section 3.2)."""

from __future__ import annotations

import math

from mpmfw.kernels import device, kernel
from mpmfw.kernels.polyline import segment_coordinate, signed_distance
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw_contact.surfaces.facing import turn_to_facing


@device
def boxes_apart(a: int, b: int, lower: Floats, upper: Floats, reach: Float) -> bool:
    """Whether the bounding boxes of bodies a and b are farther apart than ``reach`` [m] along an axis."""
    apart = False
    for d in range(2):
        if lower[a, d] - upper[b, d] > reach or lower[b, d] - upper[a, d] > reach:
            apart = True
    return apart


@kernel
def near_boxes(
    first: Ints,
    second: Ints,
    lower: Floats,
    upper: Floats,
    reach: float,
    near_lower: Floats,
    near_upper: Floats,
) -> bool:
    """Box of what of each body may be within ``reach`` [m] of another, empty for most; whether there are any.

    Of pairs with boxes closer than that it is the part within the other's box, widened by the reach; of more than one the
    box round them.
    """
    near = False
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
def outside_near(s: int, e: int, b: int, position: Floats, near_lower: Floats, near_upper: Floats) -> bool:
    """Whether the segment from node s to node e has nothing in its body's near box."""
    outside = False
    for d in range(2):
        low, high = min(position[s, d], position[e, d]), max(position[s, d], position[e, d])
        if high < near_lower[b, d] or low > near_upper[b, d]:
            outside = True
    return outside


@device
def cell_of(x: Float, lower: Float, h: Float, nodes: int) -> int:
    """Index of the cell that holds x, limited to the grid."""
    cell: int = math.floor((x - lower) / h)
    return min(max(cell, 0), nodes - 2)


@kernel
def mark_shared_nodes(
    stamp: int,
    n_bodies: int,
    position: Floats,
    following: Ints,
    body: Ints,
    near_lower: Floats,
    near_upper: Floats,
    lower: Floats,
    spacing: tuple[float, ...],
    grid_nodes: Ints,
    owner: Ints,
    shared: Ints,
) -> bool:
    """Step 1: mark the grid nodes that the surfaces of two bodies reach; return whether there are any.

    Only what lies in its body's near box counts (:func:`near_boxes`).

    A segment reaches the nodes of all cells that its bounding box touches. ``owner`` holds stamp * n_bodies +
    body of the first to arrive; since the stamp grows, nothing needs clearing.
    """
    found = False
    base = stamp * n_bodies
    for s in range(len(body)):
        e = following[s]
        if outside_near(s, e, body[s], position, near_lower, near_upper):
            continue
        i0 = cell_of(min(position[s, 0], position[e, 0]), lower[0], spacing[0], grid_nodes[0])
        i1 = cell_of(max(position[s, 0], position[e, 0]), lower[0], spacing[0], grid_nodes[0])
        j0 = cell_of(min(position[s, 1], position[e, 1]), lower[1], spacing[1], grid_nodes[1])
        j1 = cell_of(max(position[s, 1], position[e, 1]), lower[1], spacing[1], grid_nodes[1])
        for i in range(i0, i1 + 2):
            for j in range(j0, j1 + 2):
                node = i * grid_nodes[1] + j
                if owner[node] < base:
                    owner[node] = base + body[s]
                elif owner[node] != base + body[s]:
                    shared[node] = stamp
                    found = True
    return found


@device
def tagged(i: int, j: int, stamp: int, columns: int, shared: Ints) -> bool:
    """Whether a corner of cell (i, j) is shared."""
    node = i * columns + j
    shared_now: bool = (
        shared[node] == stamp
        or shared[node + 1] == stamp
        or shared[node + columns] == stamp
        or shared[node + columns + 1] == stamp
    )
    return shared_now


@kernel
def list_segments(
    stamp: int,
    position: Floats,
    following: Ints,
    body: Ints,
    near_lower: Floats,
    near_upper: Floats,
    lower: Floats,
    spacing: tuple[float, ...],
    grid_nodes: Ints,
    shared: Ints,
    head: Ints,
    head_stamp: Ints,
    link: Indices,
    link_segment: Indices,
) -> int:
    """Step 2: linked lists of the segments in every tagged cell; return the number of entries, stored or
    not."""
    count = 0
    columns = grid_nodes[1]
    for s in range(len(following)):
        e = following[s]
        if outside_near(s, e, body[s], position, near_lower, near_upper):
            continue
        i0 = cell_of(min(position[s, 0], position[e, 0]), lower[0], spacing[0], grid_nodes[0])
        i1 = cell_of(max(position[s, 0], position[e, 0]), lower[0], spacing[0], grid_nodes[0])
        j0 = cell_of(min(position[s, 1], position[e, 1]), lower[1], spacing[1], grid_nodes[1])
        j1 = cell_of(max(position[s, 1], position[e, 1]), lower[1], spacing[1], grid_nodes[1])
        for i in range(i0, i1 + 1):
            for j in range(j0, j1 + 1):
                if tagged(i, j, stamp, columns, shared):
                    if count < len(link):
                        cell = i * columns + j
                        link[count] = head[cell] if head_stamp[cell] == stamp else -1
                        link_segment[count] = s
                        head[cell] = count
                        head_stamp[cell] = stamp
                    count += 1
    return count


@device
def keep_nearest(
    s: int, m: int, other: int, gap: Float, xi: Float, e_x: Float, e_y: Float,
    master: Ints, segment: Ints, coordinate: Floats, gaps: Floats, normal: Floats,
) -> None:  # fmt: skip
    """Keep the closest segment of each other body; of equally close ones that with the lower index.

    The force is shared by neighbours that are equally close (:func:`.pair_force.equally_close`), whichever is kept.
    Where more bodies are near than there are slots, the farthest gives way, so that the order of search does not matter.
    """
    farthest = 0
    for j in range(master.shape[1]):
        free = segment[s, j] < 0
        if free or master[s, j] == other:
            nearer = abs(gap) < abs(gaps[s, j]) or (abs(gap) == abs(gaps[s, j]) and m < segment[s, j])
            if free or nearer:
                master[s, j], segment[s, j], coordinate[s, j], gaps[s, j] = other, m, xi, gap
                normal[s, j, 0], normal[s, j, 1] = e_x, e_y
            return
        worse = abs(gaps[s, j]) > abs(gaps[s, farthest])
        tie = abs(gaps[s, j]) == abs(gaps[s, farthest]) and master[s, j] > master[s, farthest]
        if worse or tie:
            farthest = j
    j = farthest
    if abs(gap) < abs(gaps[s, j]) or (abs(gap) == abs(gaps[s, j]) and other < master[s, j]):
        master[s, j], segment[s, j], coordinate[s, j], gaps[s, j] = other, m, xi, gap
        normal[s, j, 0], normal[s, j, 1] = e_x, e_y


#: The nine cells round a cell, the own one first.
NEIGHBOURS = (4, 0, 1, 2, 3, 5, 6, 7, 8)

#: Allowance for rounding where boxes are compared with a distance, so that of equally close segments none is lost.
ROUNDING = 1.0 + 1e-12


@device
def reach_of(s: int, radius: Float, segment: Ints, gap: Floats) -> Float:
    """How far a better candidate of node s may be: the radius, or the distance found if there is one slot only."""
    if segment.shape[1] == 1 and segment[s, 0] >= 0:
        return abs(gap[s, 0]) * ROUNDING
    return radius


@device
def reach_towards(s: int, other: int, radius: Float, master: Ints, segment: Ints, gap: Floats) -> Float:
    """How far a better segment of body ``other`` may be from node s: the radius, or the distance found if there is one."""
    for j in range(segment.shape[1]):
        if segment[s, j] >= 0 and master[s, j] == other:
            return abs(gap[s, j]) * ROUNDING + (ROUNDING - 1.0) * radius
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
    s: int, i: int, j: int, x: Float, y: Float, radius: Float, lower: Floats,
    spacing: tuple[float, ...], segment: Ints, gap: Floats,
) -> bool:  # fmt: skip
    """Whether cell (i, j) is farther than what was found already; true for literal detection only beyond the radius."""
    x0, y0 = lower[0] + i * spacing[0], lower[1] + j * spacing[1]
    return outside_box(x, y, x0, x0 + spacing[0], y0, y0 + spacing[1], reach_of(s, radius, segment, gap))


@device
def too_far(m: int, x: Float, y: Float, reach: Float, position: Floats, following: Ints) -> bool:
    """Whether the segment's bounding box is farther than ``reach``: spares most distances."""
    e = following[m]
    x0, x1 = min(position[m, 0], position[e, 0]), max(position[m, 0], position[e, 0])
    y0, y1 = min(position[m, 1], position[e, 1]), max(position[m, 1], position[e, 1])
    return outside_box(x, y, x0, x1, y0, y1, reach)


@kernel
def find_pairs(
    stamp: int,
    radius: float,
    literal: bool,
    position: Floats,
    following: Ints,
    previous: Ints,
    body: Ints,
    rank: Ints,
    near_lower: Floats,
    near_upper: Floats,
    lower: Floats,
    spacing: tuple[float, ...],
    grid_nodes: Ints,
    shared: Ints,
    head: Ints,
    head_stamp: Ints,
    link: Indices,
    link_segment: Indices,
    master: Ints,
    segment: Ints,
    coordinate: Floats,
    gap: Floats,
    normal: Floats,
) -> int:
    """Step 3: for every slave node in a tagged cell the closest point of each other body within ``radius``, on a segment
    that faces it.


    ``literal`` takes instead, as [H17] writes it, every segment with g_n < 0 and 0 ≤ ξ ≤ 1 one of whose ends
    lies within the radius, up to the number of slots. Nodes of body a are slaves to segments of b if ``rank[a]`` is no
    higher than ``rank[b]``. Return the number of candidates.
    """
    count = 0
    columns = grid_nodes[1]
    segment[:] = -1
    for s in range(len(body)):
        x, y = position[s, 0], position[s, 1]
        if outside_near(s, s, body[s], position, near_lower, near_upper):
            continue
        ci = cell_of(x, lower[0], spacing[0], grid_nodes[0])
        cj = cell_of(y, lower[1], spacing[1], grid_nodes[1])
        if not tagged(ci, cj, stamp, columns, shared):
            continue
        for visit in range(9):  # the own cell first: what is found there spares most of the others
            i = ci if visit == 0 else ci - 1 + NEIGHBOURS[visit] // 3
            j = cj if visit == 0 else cj - 1 + NEIGHBOURS[visit] % 3
            if i < 0 or j < 0 or i > grid_nodes[0] - 2 or j > columns - 2:
                continue
            cell = i * columns + j
            entry = head[cell] if head_stamp[cell] == stamp else -1
            if entry < 0 or cell_too_far(s, i, j, x, y, radius, lower, spacing, segment, gap):
                continue
            while entry >= 0:
                m = link_segment[entry]
                entry = link[entry]
                other = body[m]
                if other == body[s] or rank[body[s]] > rank[other]:
                    continue
                if literal:
                    keep_literal(
                        s, m, other, radius, position, following, master, segment, coordinate, gap, normal
                    )
                    continue
                reach = reach_towards(s, other, radius, master, segment, gap)
                if not too_far(m, x, y, reach, position, following):
                    g, xi, e_x, e_y = signed_distance(x, y, m, position, following, previous)
                    if abs(g) < radius:
                        keep_nearest(s, m, other, g, xi, e_x, e_y, master, segment, coordinate, gap, normal)
        if not literal:
            turn_to_facing(
                s, radius, position, following, previous,
                master, segment, coordinate, gap, normal,
            )  # fmt: skip
        for j in range(master.shape[1]):
            if segment[s, j] >= 0:
                count += 1
    return count


@device
def keep_literal(
    s: int, m: int, other: int, radius: Float, position: Floats, following: Ints,
    master: Ints, segment: Ints, coordinate: Floats, gap: Floats, normal: Floats,
) -> None:  # fmt: skip
    """Eq. 10: g_n < 0 and 0 ≤ ξ ≤ 1, with an end of the segment within the radius; each segment once."""
    e = following[m]
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
    for j in range(master.shape[1]):
        if segment[s, j] == m:
            return
        if segment[s, j] < 0:
            master[s, j], segment[s, j], coordinate[s, j], gap[s, j] = other, m, xi, g
            normal[s, j, 0], normal[s, j, 1] = ty, -tx
            return
