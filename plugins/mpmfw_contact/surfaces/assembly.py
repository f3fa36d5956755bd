"""Rows of candidates: a node against a point of a facet, as weights of grid nodes."""

from __future__ import annotations

import math

from mpmfw.kernels import device, kernel
from mpmfw.kernels.pair_table import pair_index
from mpmfw.kernels.polyline import signed_distance
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw_contact.surfaces.facing import faces

#: Difference of distances, in lengths of a segment, below which two segments are equally close: what rounding leaves.
TIE = 1e-9


@device
def length_along(a: int, e_x: Float, e_y: Float, position: Floats, following: Ints) -> Float:
    """(x_2 − x_1)·e_t of segment a [m], e_t = (−e_n,y, e_n,x)."""
    b = following[a]
    along: Float = -e_y * (position[b, 0] - position[a, 0]) + e_x * (position[b, 1] - position[a, 1])
    return along


@device
def equally_close(
    s: int, m: int, xi: Float, gap: Float, e_x: Float, e_y: Float, position: Floats, following: Ints, previous: Ints
) -> tuple[int, Float, Float, Float, Float]:  # fmt: skip
    """The neighbour of segment m to which node s is as close, and the share of the contact that it takes.

    Where a node meets a vertex head-on, or is as deep under both sides of a corner, each of the two segments is as good as
    the other: the contact is then with both, in shares w_i = L_i² / (L_1² + L_2²) of their lengths along the tangent. Of the
    distance, which has a ridge there, that is a subgradient, and no index decides.

    Returns
    -------
    First node of the neighbour, its share (0 without a tie, 1 if segment m has no length along the tangent), its ξ and e_n.
    """
    own = max(length_along(m, e_x, e_y, position, following), 0.0)
    nearer, farther = previous[m], following[m]
    if xi > 0.5:
        nearer, farther = farther, nearer
    for other in (nearer, farther):
        g, other_xi, n_x, n_y = signed_distance(
            position[s, 0], position[s, 1], other, position, following, previous
        )
        along = max(length_along(other, n_x, n_y, position, following), 0.0)
        if abs(g - gap) <= TIE * max(own, along) and along > 0.0:
            at_vertex = (xi == 0.0 or xi == 1.0) and (other_xi == 0.0 or other_xi == 1.0)
            if at_vertex or faces(s, other, position, following, previous):
                return other, along * along / (own * own + along * along), other_xi, n_x, n_y
    return m, 0.0, xi, e_x, e_y


@device
def share_across(s: int, e_x: Float, e_y: Float, position: Floats, following: Ints, previous: Ints) -> Float:
    """Of a node's two segments, the part of their length that lies across e_n and faces it; 1 on a flat face."""
    a, b = previous[s], following[s]
    before_x, before_y = position[s, 0] - position[a, 0], position[s, 1] - position[a, 1]
    after_x, after_y = position[b, 0] - position[s, 0], position[b, 1] - position[s, 1]
    length = math.hypot(before_x, before_y) + math.hypot(after_x, after_y)
    return (max(before_x * e_y - before_y * e_x, 0.0) + max(after_x * e_y - after_y * e_x, 0.0)) / length


@device
def add_point(
    p: int, share: Float, low: int, top: int, turn: Floats, lean: Floats, c: int, corner: int,
    row: Ints, nodes: Indices, weight: Floats, dof: Ints, out: Floats, couple: Floats, tilt: Floats,
) -> int:  # fmt: skip
    """Add ``share`` times N_i of surface node p to the row's entries ``low:top``; the new top.

    ``corner`` is the facet's corner that p is, −1 of the slave node: its couple and tilt go with it.
    """
    for k in range(row[p], row[p + 1]):
        if weight[k] == 0.0:
            continue
        entry = top
        for j in range(low, top):
            if dof[j] == nodes[k]:
                entry = j
        if entry == top:
            top += 1
            dof[entry], out[entry] = nodes[k], 0.0
            for d in range(couple.shape[1]):
                if len(couple) > 0:
                    couple[entry, d] = 0.0
                if len(tilt) > 0:
                    tilt[entry, d] = 0.0
        out[entry] += share * weight[k]
        if corner >= 0:
            for d in range(couple.shape[1]):
                if len(couple) > 0:
                    couple[entry, d] += weight[k] * turn[c, corner, d]
                if len(tilt) > 0:
                    tilt[entry, d] += weight[k] * lean[c, corner, d]
    return top


@device
def width_of(s: int, m: int, facet: Ints, row: Ints) -> int:
    """Entries that a row of node s and facet m may take."""
    width: int = row[s + 1] - row[s]
    for corner in range(facet.shape[1]):
        width += row[facet[m, corner] + 1] - row[facet[m, corner]]
    return width


@device
def write_geometry(
    c: int, m: int, xi: Float, g: Float, e_x: Float, e_y: Float, position: Floats, following: Ints,
    normal: Floats, share: Floats, turn: Floats, lean: Floats,
) -> None:  # fmt: skip
    """Normal, barycentric coordinates, couple and tilt of row c in the plane.

    The couple of corner a is g ∇ξ_a, ξ_a varied along the tangent e_t = (−e_n,y, e_n,x): by it f_t acts along e_n, and the pair
    leaves no moment g f_t. At a vertex, where e_n is not the segment's normal, the lever is the length along e_t. The tilt
    −(g / l) Q of eq. 7, the normal varied with the segment, takes the segment's own tangent: any other would leave a moment.
    """
    e = following[m]
    t_x, t_y = position[e, 0] - position[m, 0], position[e, 1] - position[m, 1]
    normal[c, 0], normal[c, 1] = e_x, e_y
    share[c, 0], share[c, 1] = 1.0 - xi, xi
    if len(turn) > 0:
        lever = -e_y * t_x + e_x * t_y
        over = (
            g / lever if lever > 0.0 else 0.0
        )  # beyond an end, in the segment's direction: nothing is carried there
        turn[c, 1, 0], turn[c, 1, 1] = -over * e_y, over * e_x
        turn[c, 0, 0], turn[c, 0, 1] = over * e_y, -over * e_x
    if len(lean) > 0:
        over = g / (t_x * t_x + t_y * t_y)
        lean[c, 0, 0], lean[c, 0, 1] = over * t_x, over * t_y
        lean[c, 1, 0], lean[c, 1, 1] = -over * t_x, -over * t_y


@device
def next_candidate(s: int, last: int, master: Ints, segment: Ints) -> int:
    """Slot of the candidate of node s that follows ``last`` (−1: the first), by body and segment; −1 after all."""
    found = -1
    for j in range(segment.shape[1]):
        if segment[s, j] < 0:
            continue
        if last >= 0 and not (
            master[s, j] > master[s, last]
            or (master[s, j] == master[s, last] and segment[s, j] > segment[s, last])
        ):
            continue
        if found < 0 or (
            master[s, j] < master[s, found]
            or (master[s, j] == master[s, found] and segment[s, j] < segment[s, found])
        ):
            found = j
    slot: int = found
    return slot


@kernel
def assemble(
    passes: float, across: bool, ties: bool, master: Ints, segment: Ints, coordinate: Floats, gaps: Floats, directions: Floats,
    position: Floats, displacement: Floats, tributary: Floats, following: Ints, previous: Ints, body: Ints, facet: Ints,
    pair_of: Ints, pair_first: Ints, row: Ints, nodes: Indices, weight: Floats, n_bodies: int,
    pair: Ints, identity: Ints, sign: Floats, gap: Floats, area: Floats, whole: Floats, normal: Floats, motion: Floats,
    start: Ints, dof: Ints, out: Floats, couple: Floats, tilt: Floats,
    slave: Ints, on: Ints, share: Floats, turn: Floats, lean: Floats,
) -> int:  # fmt: skip
    """A row for each candidate, two where it meets two facets alike; their number, or −1 where there is no room for all.

    ``passes`` is the part of a node's tributary length that counts in one pass; ``across`` says whether only what lies across
    the normal does.
    """
    c, top, dim = 0, 0, position.shape[1]
    for s in range(len(body)):
        j = next_candidate(s, -1, master, segment)
        while j >= 0:
            m, xi, g = segment[s, j], coordinate[s, j], gaps[s, j]
            e_x, e_y = directions[s, j, 0], directions[s, j, 1]
            other, part, other_xi, o_x, o_y = m, 0.0, xi, e_x, e_y
            if ties and g < 0.0:
                other, part, other_xi, o_x, o_y = equally_close(
                    s, m, xi, g, e_x, e_y, position, following, previous
                )
            for visit in range(2):
                taken = 1.0 - part if visit == 0 else part
                if taken == 0.0:
                    continue
                if visit == 1:
                    m, xi, e_x, e_y = other, other_xi, o_x, o_y
                if c >= len(pair) or top + width_of(s, m, facet, row) > len(dof):
                    return -1
                write_geometry(c, m, xi, g, e_x, e_y, position, following, normal, share, turn, lean)
                a, b = body[s], body[m]
                index = pair_index(pair_of, a, b)
                pair[c], identity[c], gap[c] = index, s * n_bodies + b, g
                sign[c] = 1.0 if pair_first[index] == a else -1.0
                slave[c], on[c] = s, m
                whole[c] = taken * passes * tributary[s]
                area[c] = whole[c]
                if across:
                    area[c] *= share_across(s, e_x, e_y, position, following, previous)
                start[c] = top
                top = add_point(
                    s, 1.0, start[c], top, turn, lean, c, -1, row, nodes, weight, dof, out, couple, tilt
                )
                for d in range(dim):
                    motion[c, d] = displacement[s, d]
                for corner in range(dim):
                    p, along = facet[m, corner], 0.0
                    top = add_point(
                        p, -share[c, corner], start[c], top, turn, lean, c, corner,
                        row, nodes, weight, dof, out, couple, tilt,
                    )  # fmt: skip
                    for d in range(dim):
                        motion[c, d] -= share[c, corner] * displacement[p, d]
                        along += normal[c, d] * displacement[p, d]
                    if len(turn) > 0:
                        for d in range(dim):
                            motion[c, d] += turn[c, corner, d] * along
                c += 1
                start[c] = top
            j = next_candidate(s, j, master, segment)
    return c


@kernel
def point_forces(
    count: int, slave: Ints, on: Ints, facet: Ints, share: Floats, turn: Floats, lean: Floats, normal: Floats,
    force: Floats, out: Floats,
) -> None:  # fmt: skip
    """Forces of the rows on surface nodes, (n_s, dim): what Bᵀ f maps to the grid."""
    dim = out.shape[1]
    out[:] = 0.0
    for c in range(count):
        along = 0.0
        for d in range(dim):
            along += force[c, d] * normal[c, d]
            out[slave[c], d] += force[c, d]
        for corner in range(dim):
            p, turned = facet[on[c], corner], 0.0
            if len(turn) > 0:
                for d in range(dim):
                    turned += turn[c, corner, d] * force[c, d]
            for d in range(dim):
                out[p, d] += turned * normal[c, d] - share[c, corner] * force[c, d]
                if len(lean) > 0:
                    out[p, d] += along * lean[c, corner, d]
