"""Rows of candidates: a node against a point of a facet, as weights of grid nodes."""

from __future__ import annotations

import math

from mpmfw.kernels import Struct, device, kernel
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.pair_table import pair_index
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw_contact.surfaces.candidates import Candidates
from mpmfw_contact.surfaces.facing import along_segment, faces
from mpmfw_contact.surfaces.outline import Outline, distance_to

#: Difference of distances, in lengths of a segment, below which two segments are equally close: what rounding leaves.
TIE = 1e-9


class Places(Struct):
    """Where every row is on the surfaces."""

    slave: Ints  #: (n,) surface node of the first side
    facet: Ints  #: (n,) facet of the second side
    share: Floats  #: (n, dim) barycentric coordinates on it
    turn: Floats  #: (n, dim, dim) couple of each corner; (0, dim, dim) without friction
    lean: Floats  #: (n, dim, dim) tilt of each corner; (0, dim, dim) where the variation is exact


class Table(Struct):
    """The surface's table of interpolation."""

    row: Ints  #: (n_s + 1,) entries of surface node p are ``row[p]:row[p + 1]``
    nodes: Indices  #: (m,) flat grid node
    weight: Floats  #: (m,) N_i(x_s)


@device
def length_along(a: int, e_x: Float, e_y: Float, outline: Outline) -> Float:
    """(x_2 − x_1)·e_t of segment a [m], e_t = (−e_n,y, e_n,x)."""
    x, y = along_segment(a, outline)
    along: Float = -e_y * x + e_x * y
    return along


@device
def equally_close(
    s: int, m: int, xi: Float, gap: Float, e_x: Float, e_y: Float, outline: Outline
) -> tuple[int, Float, Float, Float, Float]:
    """The neighbour of segment m to which node s is as close, and the share of the contact that it takes.

    Where a node meets a vertex head-on, or is as deep under both sides of a corner, each of the two segments is as good as
    the other: the contact is then with both, in shares w_i = L_i² / (L_1² + L_2²) of their lengths along the tangent. Of the
    distance, which has a ridge there, that is a subgradient, and no index decides.

    Returns
    -------
    First node of the neighbour, its share (0 without a tie, 1 if segment m has no length along the tangent), its ξ and e_n.
    """
    own = max(length_along(m, e_x, e_y, outline), 0.0)
    nearer, farther = outline.previous[m], outline.next[m]
    if xi > 0.5:
        nearer, farther = farther, nearer
    for other in (nearer, farther):
        g, other_xi, n_x, n_y = distance_to(s, other, outline)
        along = max(length_along(other, n_x, n_y, outline), 0.0)
        if abs(g - gap) <= TIE * max(own, along) and along > 0.0:
            at_vertex = (xi == 0.0 or xi == 1.0) and (other_xi == 0.0 or other_xi == 1.0)
            if at_vertex or faces(s, other, outline):
                return other, along * along / (own * own + along * along), other_xi, n_x, n_y
    return m, 0.0, xi, e_x, e_y


@device
def share_across(s: int, e_x: Float, e_y: Float, outline: Outline) -> Float:
    """Of a node's two segments, the part of their length that lies across e_n and faces it; 1 on a flat face."""
    before_x, before_y = along_segment(outline.previous[s], outline)
    after_x, after_y = along_segment(s, outline)
    length = math.hypot(before_x, before_y) + math.hypot(after_x, after_y)
    return (max(before_x * e_y - before_y * e_x, 0.0) + max(after_x * e_y - after_y * e_x, 0.0)) / length


@device
def write_geometry(
    c: int, xi: Float, e_x: Float, e_y: Float, outline: Outline, rows: Rows, places: Places
) -> None:
    """Normal, barycentric coordinates, couple and tilt of row c in the plane.

    The couple of corner a is g ∇ξ_a, ξ_a varied along the tangent e_t = (−e_n,y, e_n,x): by it f_t acts along e_n, and the pair
    leaves no moment g f_t. At a vertex, where e_n is not the segment's normal, the lever is the length along e_t. The tilt
    −(g / l) Q of eq. 7, the normal varied with the segment, takes the segment's own tangent: any other would leave a moment.
    """
    g, turn, lean = rows.gap[c], places.turn, places.lean
    t_x, t_y = along_segment(places.facet[c], outline)
    rows.normal[c, 0], rows.normal[c, 1] = e_x, e_y
    places.share[c, 0], places.share[c, 1] = 1.0 - xi, xi
    if len(turn) > 0:
        lever = -e_y * t_x + e_x * t_y
        # beyond an end, in the segment's direction, there is no couple
        over = g / lever if lever > 0.0 else 0.0
        turn[c, 1, 0], turn[c, 1, 1] = -over * e_y, over * e_x
        turn[c, 0, 0], turn[c, 0, 1] = over * e_y, -over * e_x
    if len(lean) > 0:
        over = g / (t_x * t_x + t_y * t_y)
        lean[c, 0, 0], lean[c, 0, 1] = over * t_x, over * t_y
        lean[c, 1, 0], lean[c, 1, 1] = -over * t_x, -over * t_y


@device
def write_motion(c: int, outline: Outline, rows: Rows, places: Places) -> None:
    """B v Δt of row c over the last step, of the surface nodes' displacements."""
    dim = rows.motion.shape[1]
    for d in range(dim):
        rows.motion[c, d] = outline.displacement[places.slave[c], d]
    for corner in range(dim):
        p, along = outline.facets[places.facet[c], corner], 0.0
        for d in range(dim):
            rows.motion[c, d] -= places.share[c, corner] * outline.displacement[p, d]
            along += rows.normal[c, d] * outline.displacement[p, d]
        if len(places.turn) > 0:
            for d in range(dim):
                rows.motion[c, d] += places.turn[c, corner, d] * along


@device
def add_point(
    p: int, share: Float, c: int, corner: int, top: int, table: Table, rows: Rows, places: Places
) -> int:
    """Add ``share`` times N_i of surface node p to the entries of row c, which end before ``top``; the new top.

    ``corner`` is the facet's corner that p is, −1 of the slave node: its couple and tilt go with it.
    """
    dim, couple, tilt = rows.normal.shape[1], rows.couple, rows.tilt
    for k in range(table.row[p], table.row[p + 1]):
        if table.weight[k] == 0.0:
            continue
        entry = top
        for j in range(rows.start[c], top):
            if rows.dof[j] == table.nodes[k]:
                entry = j
        if entry == top:
            top += 1
            rows.dof[entry], rows.weight[entry] = table.nodes[k], 0.0
            for d in range(dim):
                if len(couple) > 0:
                    couple[entry, d] = 0.0
                if len(tilt) > 0:
                    tilt[entry, d] = 0.0
        rows.weight[entry] += share * table.weight[k]
        if corner >= 0:
            for d in range(dim):
                if len(couple) > 0:
                    couple[entry, d] += table.weight[k] * places.turn[c, corner, d]
                if len(tilt) > 0:
                    tilt[entry, d] += table.weight[k] * places.lean[c, corner, d]
    return top


@device
def width_of(s: int, m: int, facets: Ints, row: Ints) -> int:
    """Entries that a row of node s and facet m may take."""
    width: int = row[s + 1] - row[s]
    for corner in range(facets.shape[1]):
        width += row[facets[m, corner] + 1] - row[facets[m, corner]]
    return width


@device
def next_candidate(s: int, last: int, candidates: Candidates) -> int:
    """Slot of the candidate of node s that follows ``last`` (−1: the first), by body and segment; −1 after all."""
    master, segment = candidates.master, candidates.segment
    following = -1
    for j in range(segment.shape[1]):
        if segment[s, j] < 0:
            continue
        if last >= 0 and not (
            master[s, j] > master[s, last]
            or (master[s, j] == master[s, last] and segment[s, j] > segment[s, last])
        ):
            continue
        if following < 0 or (
            master[s, j] < master[s, following]
            or (master[s, j] == master[s, following] and segment[s, j] < segment[s, following])
        ):
            following = j
    slot: int = following
    return slot


@kernel
def assemble(
    passes: float, across: bool, ties: bool, candidates: Candidates, outline: Outline, pair_of: Ints, pair_first: Ints,
    table: Table, rows: Rows, places: Places,
) -> int:  # fmt: skip
    """A row for each candidate, two where it meets two facets alike; their number, or −1 where there is no room for all.

    ``passes`` is the part of a node's tributary length that counts in one pass. ``across`` says whether only what
    lies across the normal is a row's area, ``ties`` whether of two equally close segments both count.
    """
    c, top, body = 0, 0, outline.body
    n_bodies = len(outline.body_first) - 1
    for s in range(len(body)):
        j = next_candidate(s, -1, candidates)
        while j >= 0:
            m, xi, g = candidates.segment[s, j], candidates.coordinate[s, j], candidates.gap[s, j]
            e_x, e_y = candidates.normal[s, j, 0], candidates.normal[s, j, 1]
            other, part, other_xi, o_x, o_y = m, 0.0, xi, e_x, e_y
            if ties and g < 0.0:
                other, part, other_xi, o_x, o_y = equally_close(s, m, xi, g, e_x, e_y, outline)
            for visit in range(2):
                taken = 1.0 - part if visit == 0 else part
                if taken == 0.0:
                    continue
                if visit == 1:
                    m, xi, e_x, e_y = other, other_xi, o_x, o_y
                if c >= len(rows.pair) or top + width_of(s, m, outline.facets, table.row) > len(rows.dof):
                    return -1
                p = pair_index(pair_of, body[s], body[m])
                rows.pair[c], rows.identity[c], rows.gap[c] = p, s * n_bodies + body[m], g
                rows.sign[c] = 1.0 if pair_first[p] == body[s] else -1.0
                rows.whole[c] = taken * passes * outline.tributary[s]
                rows.area[c] = rows.whole[c]
                if across:
                    rows.area[c] *= share_across(s, e_x, e_y, outline)
                places.slave[c], places.facet[c] = s, m
                write_geometry(c, xi, e_x, e_y, outline, rows, places)
                write_motion(c, outline, rows, places)
                rows.start[c] = top
                top = add_point(s, 1.0, c, -1, top, table, rows, places)
                for corner in range(outline.facets.shape[1]):
                    node = outline.facets[m, corner]
                    top = add_point(node, -places.share[c, corner], c, corner, top, table, rows, places)
                c += 1
                rows.start[c] = top
            j = next_candidate(s, j, candidates)
    return c


@kernel
def point_forces(rows: Rows, count: int, facets: Ints, places: Places, out: Floats) -> None:
    """Forces of the rows on surface nodes, (n_s, dim): what Bᵀ f maps to the grid."""
    dim = out.shape[1]
    out[:] = 0.0
    for c in range(count):
        along = 0.0
        for d in range(dim):
            along += rows.force[c, d] * rows.normal[c, d]
            out[places.slave[c], d] += rows.force[c, d]
        for corner in range(dim):
            p, turned = facets[places.facet[c], corner], 0.0
            if len(places.turn) > 0:
                for d in range(dim):
                    turned += places.turn[c, corner, d] * rows.force[c, d]
            for d in range(dim):
                out[p, d] += turned * rows.normal[c, d] - places.share[c, corner] * rows.force[c, d]
                if len(places.lean) > 0:
                    out[p, d] += along * places.lean[c, corner, d]
