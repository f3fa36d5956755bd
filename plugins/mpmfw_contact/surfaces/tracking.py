"""A node inside another body is followed until it is seen to come out, however deep it is and however fast it moved."""

from __future__ import annotations

import math
from typing import Any

from mpmfw.api import FloatArray, SimulationError, State
from mpmfw.kernels import device, kernel
from mpmfw.kernels.polyline import segment_coordinate, squared_distance
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw_contact.surfaces.candidates import Candidates, SearchGrid, put
from mpmfw_contact.surfaces.facing import LEAST_COSINE, along_segment, node_normal
from mpmfw_contact.surfaces.outline import Outline, distance_to
from mpmfw_contact.surfaces.search import boxes_apart

#: Least cosine between a slave node's normal and the direction out of a body by which the node has gone through it: one
#: that leaves the way it entered, or round a corner, has an angle of 90° or more, or little less.
THROUGH = 0.7

#: How far beyond the far side of a body, in cells, a node may be before the bodies count as crossed.
CROSSED = 1.0


@device
def nearest_segment(s: int, first: int, last: int, outline: Outline) -> int:
    """Of the segments ``first:last`` the one nearest to node s; of equally near ones the first."""
    x, y = outline.position[s, 0], outline.position[s, 1]
    nearest, closest = math.inf, first
    for m in range(first, last):
        square = squared_distance(x, y, m, outline.position, outline.next)
        if square < nearest:
            nearest, closest = square, m
    return closest


@device
def opposition(s: int, m: int, outline: Outline) -> Float:
    """Cosine between the reversed outward normal of node s and that of segment m."""
    n_x, n_y = node_normal(s, outline)
    x, y = along_segment(m, outline)
    cosine: Float = (n_y * x - n_x * y) / (math.hypot(n_x, n_y) * math.hypot(x, y))
    return cosine


@device
def walk(s: int, m: int, outline: Outline) -> int:
    """Segment that is locally nearest to node s, reached from segment m along segments that face the node.

    From a segment that does not, the way is free to those that face it more.
    """
    position, following = outline.position, outline.next
    x, y = position[s, 0], position[s, 1]
    least = squared_distance(x, y, m, position, following)
    for _ in range(len(following)):
        bound = min(opposition(s, m, outline), LEAST_COSINE)
        nearer = -1
        for n in (following[m], outline.previous[m]):
            square = squared_distance(x, y, n, position, following)
            if square < least and opposition(s, n, outline) >= bound:
                nearer, least = n, square
        if nearer < 0:
            break
        m = nearer
    return m


@device
def behind(s: int, m: int, outline: Outline) -> tuple[Float, Float, Float, Float]:
    """Gap, ξ and direction e_n of a node that is behind segment m: the gap is positive if it is in front after all.

    Where the closest point is an end, the node is behind it whatever the pseudo-normal there says: a nearer segment may
    be round the corner.
    """
    g, xi, e_x, e_y = distance_to(s, m, outline)
    if g > 0.0 and (xi == 0.0 or xi == 1.0):
        g, e_x, e_y = -g, -e_x, -e_y
    return g, xi, e_x, e_y


@device
def place_of(s: int, other: int, candidates: Candidates) -> Any:
    """Slot of node s that has a candidate of body ``other``, else −1; and one for a new candidate: a free one, else that
    of the largest gap."""
    segment, gap = candidates.segment, candidates.gap
    slot, place = -1, 0
    for j in range(segment.shape[1]):
        if segment[s, j] >= 0 and candidates.master[s, j] == other:
            slot = j
        if segment[s, place] >= 0 and (segment[s, j] < 0 or gap[s, j] > gap[s, place]):
            place = j
    return slot, place


@kernel
def keep_inside(outline: Outline, candidates: Candidates, through: Floats) -> int:
    """Give nodes that were inside a body, and that the search has lost, the closest point of its outline that faces them.

    The search covers what is within its radius, and facing segments near the closest one. A node that it has lost has come
    out, round a corner, or it is deeper than that, or it has gone through to the far side; only the first is let go. Of
    those that went through, ``through`` (3,) says how far the farthest is beyond the far side [m], its index, and the body's.

    Returns
    -------
    Number of candidates added.
    """
    added = 0
    through[0] = 0.0
    for s in range(len(outline.body)):
        for i in range(candidates.inside.shape[1]):
            other = candidates.inside[s, i]
            if other < 0:
                continue
            slot, place = place_of(s, other, candidates)
            if slot >= 0:
                continue
            m = nearest_segment(s, outline.body_first[other], outline.body_first[other + 1], outline)
            out, _, e_x, e_y = distance_to(s, m, outline)
            if out >= 0.0:
                n_x, n_y = node_normal(s, outline)
                if n_x * e_x + n_y * e_y < THROUGH * math.hypot(n_x, n_y):
                    continue
                if out > through[0]:
                    through[0], through[1], through[2] = out, float(s), float(other)
            m = walk(s, candidates.inside_segment[s, i], outline)
            g, xi, e_x, e_y = behind(s, m, outline)
            if g < 0.0:
                added += 1 if candidates.segment[s, place] < 0 else 0
                put(s, place, other, m, g, xi, e_x, e_y, candidates)
    return added


@device
def coordinate_then(s: int, m: int, back: Float, outline: Outline) -> tuple[Float, Float]:
    """ξ of node s on segment m and its gap [m] where they were the part ``back`` of their last displacements ago."""
    position, moved, e = outline.position, outline.displacement, outline.next[m]
    xi, gap, _, _, _ = segment_coordinate(
        position[s, 0] - back * moved[s, 0], position[s, 1] - back * moved[s, 1],
        position[m, 0] - back * moved[m, 0], position[m, 1] - back * moved[m, 1],
        position[e, 0] - back * moved[e, 0], position[e, 1] - back * moved[e, 1],
    )  # fmt: skip
    return xi, gap


@device
def crosses(s: int, m: int, outline: Outline) -> bool:
    """Whether node s came through segment m from its front in the last step, both taken to have moved evenly."""
    _, now = coordinate_then(s, m, 0.0, outline)
    if now >= 0.0:
        return False
    _, before = coordinate_then(s, m, 1.0, outline)
    if before < 0.0:
        return False
    xi, _ = coordinate_then(s, m, -now / (before - now), outline)  # at the crossing
    through: bool = xi >= 0.0 and xi <= 1.0
    return through


@device
def outside_body(s: int, b: int, reach: Float, outline: Outline, grid: SearchGrid) -> bool:
    """Whether node s is farther than ``reach`` [m] from the box of body b along an axis."""
    outside = False
    for d in range(2):
        x = outline.position[s, d]
        if x < grid.box_lower[b, d] - reach or x > grid.box_upper[b, d] + reach:
            outside = True
    return outside


@kernel
def find_crossings(
    least_travel: float, outline: Outline, first: Ints, second: Ints, rank: Ints, grid: SearchGrid, candidates: Candidates
) -> int:  # fmt: skip
    """Add nodes that came in through a segment in the last step, and that the search has not seen: they are nearer to the far
    side of a thin body already, or came by a flank that does not face them.

    Nothing is looked for where no node has moved by ``least_travel`` [m].

    Returns
    -------
    Number of candidates added.
    """
    added, travel, body_first = 0, 0.0, outline.body_first
    for s in range(body_first[-1]):
        for d in range(2):
            travel = max(travel, 2.0 * abs(outline.displacement[s, d]))
    if travel < 2.0 * least_travel:
        return 0
    for c in range(2 * len(first)):
        mine, other = (first[c // 2], second[c // 2]) if c % 2 == 0 else (second[c // 2], first[c // 2])
        if rank[mine] > rank[other] or boxes_apart(mine, other, grid.box_lower, grid.box_upper, travel):
            continue
        for s in range(body_first[mine], body_first[mine + 1]):
            if outside_body(s, other, travel, outline, grid):
                continue
            slot, place = place_of(s, other, candidates)
            if slot >= 0 or candidates.segment[s, place] >= 0:
                continue
            for m in range(body_first[other], body_first[other + 1]):
                if crosses(s, m, outline):
                    g, xi, e_x, e_y = behind(s, m, outline)
                    put(s, place, other, m, g, xi, e_x, e_y, candidates)
                    added += 1
                    break
    return added


def crossed(state: State, through: FloatArray) -> SimulationError:
    """What stops a run in which a node has gone through another body: pair, place and time.

    ``through`` is what :func:`keep_inside` found.
    """
    surface = state.surface
    if surface is None:
        raise RuntimeError("no surface is tracked")
    beyond, node, other = float(through[0]), int(through[1]), int(through[2])
    mine = int(surface.body[node])
    pair = next(pair for pair in state.pairs if {pair.first, pair.second} == {mine, other})
    return SimulationError(
        f"{pair.label}: the bodies have crossed: a surface node came out by the far side of "
        f"'{state.bodies[other].name}', and is {beyond / state.grid.cell_size:.2g} cells beyond it",
        body=state.bodies[mine].name,
        index=node - int(surface.body_first[mine]),
        position=surface.position[node].tolist(),
        time=state.time,
        advice="a slower impact, a stiffer contact, or smaller cells",
    )


@kernel
def remember_inside(candidates: Candidates) -> None:
    """Note for the next step which nodes are inside which bodies."""
    segment = candidates.segment
    for s in range(len(segment)):
        for j in range(segment.shape[1]):
            inside = segment[s, j] >= 0 and candidates.gap[s, j] < 0.0
            candidates.inside[s, j] = candidates.master[s, j] if inside else -1
            candidates.inside_segment[s, j] = segment[s, j]
