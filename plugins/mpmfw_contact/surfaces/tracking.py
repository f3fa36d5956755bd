"""A node inside another body stays known until it is seen to come out, however deep it is and however fast it came."""

from __future__ import annotations

import math
from typing import Any

from mpmfw.api import FloatArray, SimulationError, State
from mpmfw.kernels import device, kernel
from mpmfw.kernels.polyline import segment_coordinate, signed_distance, squared_distance
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw_contact.surfaces.facing import LEAST_COSINE, node_normal
from mpmfw_contact.surfaces.search import boxes_apart

#: Least cosine between a slave node's normal and the direction out of a body by which the node has gone through it: one
#: that leaves the way it came, or round a corner, has an angle of 90° or more, or little less.
THROUGH = 0.7

#: How far beyond the far side of a body, in cells, a node may be before the bodies count as crossed.
CROSSED = 1.0


@device
def nearest_segment(x: Float, y: Float, first: int, last: int, position: Floats, following: Ints) -> int:
    """Of the segments ``first:last`` the one nearest to a point; of equally near ones the first."""
    nearest, closest = math.inf, first
    for m in range(first, last):
        square = squared_distance(x, y, m, position, following)
        if square < nearest:
            nearest, closest = square, m
    return closest


@device
def opposition(s: int, m: int, position: Floats, following: Ints, previous: Ints) -> Float:
    """Cosine between the reversed outward normal of node s and that of segment m."""
    n_x, n_y = node_normal(s, position, following, previous)
    e = following[m]
    x, y = position[e, 0] - position[m, 0], position[e, 1] - position[m, 1]
    cosine: Float = (n_y * x - n_x * y) / (math.hypot(n_x, n_y) * math.hypot(x, y))
    return cosine


@device
def walk(s: int, m: int, position: Floats, following: Ints, previous: Ints) -> int:
    """Segment that is locally nearest to node s, reached from segment m along segments that face the node.

    From a segment that does not, the way is free to those that face it more.
    """
    x, y = position[s, 0], position[s, 1]
    least = squared_distance(x, y, m, position, following)
    for _ in range(len(following)):
        bound = min(opposition(s, m, position, following, previous), LEAST_COSINE)
        nearer = -1
        for n in (following[m], previous[m]):
            square = squared_distance(x, y, n, position, following)
            if square < least and opposition(s, n, position, following, previous) >= bound:
                nearer, least = n, square
        if nearer < 0:
            break
        m = nearer
    return m


@device
def behind(
    s: int, m: int, position: Floats, following: Ints, previous: Ints
) -> tuple[Float, Float, Float, Float]:
    """Gap, ξ and direction e_n of a node that is behind segment m: the gap is positive if it is in front after all.

    Where the closest point is an end, the node is behind it whatever the pseudo-normal there says: a nearer segment may
    be round the corner.
    """
    g, xi, e_x, e_y = signed_distance(position[s, 0], position[s, 1], m, position, following, previous)
    if g > 0.0 and (xi == 0.0 or xi == 1.0):
        g, e_x, e_y = -g, -e_x, -e_y
    return g, xi, e_x, e_y


@device
def place_of(s: int, other: int, master: Ints, segment: Ints, gap: Floats) -> Any:
    """Slot of node s that has a candidate of body ``other``, else −1; and one for a new candidate: a free one, else that
    of the largest gap."""
    found, place = -1, 0
    for j in range(segment.shape[1]):
        if segment[s, j] >= 0 and master[s, j] == other:
            found = j
        if segment[s, place] >= 0 and (segment[s, j] < 0 or gap[s, j] > gap[s, place]):
            place = j
    return found, place


@kernel
def keep_inside(
    position: Floats,
    following: Ints,
    previous: Ints,
    body: Ints,
    body_first: Ints,
    inside: Ints,
    inside_segment: Ints,
    master: Ints,
    segment: Ints,
    coordinate: Floats,
    gap: Floats,
    normal: Floats,
    through: Floats,
) -> int:
    """Give nodes that were inside a body, and that the search has lost, the closest point of its outline that faces them.

    The search knows what is within its radius, and facing segments near the closest one. A node that it has lost has come
    out, round a corner, or it is deeper than that, or it has gone through to the far side; only the first is let go. Of
    those that went through, ``through`` (3,) says how far the farthest is beyond the far side [m], its index, and the body's.

    Returns
    -------
    Number of candidates added.
    """
    added = 0
    through[0] = 0.0
    for s in range(len(body)):
        for i in range(inside.shape[1]):
            other = inside[s, i]
            if other < 0:
                continue
            found, place = place_of(s, other, master, segment, gap)
            if found >= 0:
                continue
            x, y = position[s, 0], position[s, 1]
            m = nearest_segment(x, y, body_first[other], body_first[other + 1], position, following)
            out, _, e_x, e_y = signed_distance(x, y, m, position, following, previous)
            if out >= 0.0:
                n_x, n_y = node_normal(s, position, following, previous)
                if n_x * e_x + n_y * e_y < THROUGH * math.hypot(n_x, n_y):
                    continue
                if out > through[0]:
                    through[0], through[1], through[2] = out, float(s), float(other)
            m = walk(s, inside_segment[s, i], position, following, previous)
            g, xi, e_x, e_y = behind(s, m, position, following, previous)
            if g < 0.0:
                added += 1 if segment[s, place] < 0 else 0
                master[s, place], segment[s, place] = other, m
                coordinate[s, place], gap[s, place] = xi, g
                normal[s, place, 0], normal[s, place, 1] = e_x, e_y
    return added


@device
def crosses(s: int, m: int, position: Floats, displacement: Floats, following: Ints) -> bool:
    """Whether node s came through segment m from its front in the last step, both taken to have moved evenly."""
    e = following[m]
    x, y = position[s, 0], position[s, 1]
    _, now, _, _, _ = segment_coordinate(x, y, position[m, 0], position[m, 1], position[e, 0], position[e, 1])
    if now >= 0.0:
        return False
    _, before, _, _, _ = segment_coordinate(
        x - displacement[s, 0], y - displacement[s, 1],
        position[m, 0] - displacement[m, 0], position[m, 1] - displacement[m, 1],
        position[e, 0] - displacement[e, 0], position[e, 1] - displacement[e, 1],
    )  # fmt: skip
    if before < 0.0:
        return False
    left = -now / (before - now)  # of the step, after the crossing
    xi, _, _, _, _ = segment_coordinate(
        x - left * displacement[s, 0], y - left * displacement[s, 1],
        position[m, 0] - left * displacement[m, 0], position[m, 1] - left * displacement[m, 1],
        position[e, 0] - left * displacement[e, 0], position[e, 1] - left * displacement[e, 1],
    )  # fmt: skip
    through: bool = xi >= 0.0 and xi <= 1.0
    return through


@kernel
def find_crossings(
    least_travel: float,
    position: Floats,
    displacement: Floats,
    following: Ints,
    previous: Ints,
    body_first: Ints,
    first: Ints,
    second: Ints,
    rank: Ints,
    box_lower: Floats,
    box_upper: Floats,
    master: Ints,
    segment: Ints,
    coordinate: Floats,
    gap: Floats,
    normal: Floats,
) -> int:
    """Add nodes that came in through a segment in the last step, and that the search has not seen: they are nearer to the far
    side of a thin body already, or came by a flank that does not face them.

    Nothing is looked for where no node has moved by ``least_travel`` [m].

    Returns
    -------
    Number of candidates added.
    """
    added, travel = 0, 0.0
    for s in range(body_first[-1]):
        for d in range(2):
            travel = max(travel, 2.0 * abs(displacement[s, d]))
    if travel < 2.0 * least_travel:
        return 0
    for c in range(2 * len(first)):
        mine, other = (first[c // 2], second[c // 2]) if c % 2 == 0 else (second[c // 2], first[c // 2])
        if rank[mine] > rank[other] or boxes_apart(mine, other, box_lower, box_upper, travel):
            continue
        for s in range(body_first[mine], body_first[mine + 1]):
            x, y = position[s, 0], position[s, 1]
            if x < box_lower[other, 0] - travel or x > box_upper[other, 0] + travel:
                continue
            if y < box_lower[other, 1] - travel or y > box_upper[other, 1] + travel:
                continue
            found, place = place_of(s, other, master, segment, gap)
            if found >= 0 or segment[s, place] >= 0:
                continue
            for m in range(body_first[other], body_first[other + 1]):
                if crosses(s, m, position, displacement, following):
                    g, xi, e_x, e_y = behind(s, m, position, following, previous)
                    master[s, place], segment[s, place] = other, m
                    coordinate[s, place], gap[s, place] = xi, g
                    normal[s, place, 0], normal[s, place, 1] = e_x, e_y
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
def remember_inside(master: Ints, segment: Ints, gap: Floats, inside: Ints, inside_segment: Ints) -> None:
    """Note for the next step which nodes are inside which bodies."""
    for s in range(len(segment)):
        for j in range(segment.shape[1]):
            held = segment[s, j] >= 0 and gap[s, j] < 0.0
            inside[s, j] = master[s, j] if held else -1
            inside_segment[s, j] = segment[s, j]
