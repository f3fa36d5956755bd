"""Rows of candidates: a node against a point of a facet, as weights of grid nodes."""

from __future__ import annotations

from mpmfw.contact.surfaces.outline import (
    Candidates,
    body_of,
    clearly_opposes,
    distance_to,
    hidden,
    node_outward,
    opposes,
)
from mpmfw.kernels import Struct, device, kernel, scratch
from mpmfw.kernels.contact import Rows, pair_index
from mpmfw.kernels.facets import (
    at_rim,
    dot,
    extent_of,
    length_of,
    read_corners,
    write_gradients,
    write_own_gradients,
)
from mpmfw.kernels.stencil import entries
from mpmfw.kernels.surfaces import area_of
from mpmfw.kernels.types import Float, Floats, Ints, Table
from mpmfw.state.structs import Surface

#: Difference of distances, in lengths of a facet, below which two facets are equally close: rounding.
TIE = 1e-9


class Places(Struct):
    """Where every row is on the surfaces."""

    slave: Ints  #: (n,) surface node of the first side
    facet: Ints  #: (n,) facet of the second side
    share: Floats  #: (n, dim) barycentric coordinates on it
    turn: Floats  #: (n, dim, dim) couple of each corner; (0, dim, dim) without friction
    lean: Floats  #: (n, dim, dim) tilt of each corner; (0, dim, dim) where the variation is exact


@device
def measure_across(m: int, normal: Floats, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """Measure of facet m across ``normal``, 0 from behind: length [m], in space twice the area [m²]."""
    area = scratch.vector(spacing)
    area_of(m, outline, area, spacing)
    return max(dot(area, normal, spacing), 0.0)


@device
def equally_close(
    s: int, m: int, share: Floats, gap: Float, normal: Floats, other_share: Floats, other_normal: Floats,
    outline: Surface, spacing: tuple[float, ...],
) -> tuple[int, Float]:  # fmt: skip
    """The neighbour of facet m to which node s is as close, and the part of the contact that it takes; 0
    without a tie, 1 if facet m has no measure across the normal.

    At a vertex met head-on, or as deep under both sides of a corner, the contact is with both, in parts w_i
    = L_i² / (L_1² + L_2²) of their measures across the normal: a subgradient of the distance, and no index
    decides. Coordinates and e_n on the neighbour go to ``other_share`` and ``other_normal``.
    """
    dim = len(spacing)
    own, looked = measure_across(m, normal, outline, spacing), False
    outward, visited = scratch.vector(spacing), scratch.integers(spacing)
    for a in range(dim):
        visited[a] = 0
    for _ in range(dim):
        corner = -1  # across the nearest side that is left; of equally near ones the last
        for a in range(dim):
            if visited[a] == 0 and (corner < 0 or share[a] <= share[corner]):
                corner = a
        visited[corner] = 1
        other = outline.neighbours[m, corner]
        if hidden(other, outline.body[s], outline):
            continue
        g = distance_to(s, other, outline, other_share, other_normal, spacing)
        across = measure_across(other, other_normal, outline, spacing)
        if abs(g - gap) <= TIE * extent_of(max(own, across), spacing) and across > 0.0:
            alike = at_rim(share, spacing) and at_rim(other_share, spacing)
            alike = alike or clearly_opposes(s, other, outline, spacing)
            if not alike and not looked:
                node_outward(s, outline.body[outline.facets[m, 0]], outline, outward, spacing)
                looked = True
            if alike or opposes(outward, other, outline, spacing):
                return other, across * across / (own * own + across * across)
    return m, 0.0


@device
def share_across(s: int, normal: Floats, outline: Surface, spacing: tuple[float, ...]) -> Float:
    """The part of a node's facets that lies across e_n and faces it; 1 on a flat face."""
    area, across, whole = scratch.vector(spacing), 0.0, 0.0
    for k in range(outline.star_first[s], outline.star_first[s + 1]):
        area_of(outline.star[k], outline, area, spacing)
        whole += length_of(area, spacing)
        across += max(-dot(area, normal, spacing), 0.0)
    return across / whole


@device
def write_geometry(
    c: int, share: Floats, normal: Floats, outline: Surface, rows: Rows, places: Places,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Normal, barycentric coordinates, couple and tilt of row c.

    The couple of corner a is g ∇ξ_a, ξ_a varied across the normal: by it f_t acts along e_n, and the pair
    leaves no moment g f_t. On the rim the facet is taken as it is seen along e_n. The tilt −g ∇ξ_a, in the
    plane −(g / l) Q of eq. 7, takes the facet's own plane: any other would leave a moment.
    """
    dim, g, turn, lean = len(spacing), rows.gap[c], places.turn, places.lean
    corners, gradient = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    read_corners(places.facet[c], outline.position, outline.facets, corners, spacing)
    for d in range(dim):
        rows.normal[c, d], places.share[c, d] = normal[d], share[d]
    if len(turn) > 0:
        write_gradients(corners, normal, g, gradient, spacing)
        for a in range(dim):
            for d in range(dim):
                turn[c, a, d] = gradient[a, d]
    if len(lean) > 0:
        write_own_gradients(corners, -g, gradient, spacing)
        for a in range(dim):
            for d in range(dim):
                lean[c, a, d] = gradient[a, d]


@device
def write_motion(
    c: int, displacement: Floats, facets: Ints, rows: Rows, places: Places, out: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """B v Δt of row c, of the surface nodes' ``displacement`` (n_s, dim) [m], into ``out`` (n, dim)."""
    dim = len(spacing)
    for d in range(dim):
        out[c, d] = displacement[places.slave[c], d]
    for corner in range(dim):
        p, along = facets[places.facet[c], corner], 0.0
        for d in range(dim):
            out[c, d] -= places.share[c, corner] * displacement[p, d]
            along += rows.normal[c, d] * displacement[p, d]
        if len(places.turn) > 0:
            for d in range(dim):
                out[c, d] += places.turn[c, corner, d] * along


@device
def add_point(
    p: int, share: Float, c: int, corner: int, top: int, table: Table, place: Ints, rows: Rows,
    places: Places, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Add ``share`` times N_i of surface node p to the entries of row c, which end before ``top``; the new
    top.

    ``corner`` is p on the facet, with couple and tilt; −1 of the slave node. ``place`` (n_nodes,) is scratch,
    nowhere negative: the entry that a grid node was given last.
    """
    dim, begin = len(spacing), rows.start[c]
    dof, out, couple, tilt = rows.dof, rows.weight, rows.couple, rows.tilt
    for k in entries(table.row, p):
        i, weight = table.nodes[k], table.weight[k]
        if weight == 0.0:
            continue
        entry = place[i]
        if entry < begin or entry >= top or dof[entry] != i:
            entry = place[i] = top
            top += 1
            dof[entry], out[entry] = i, 0.0
            for d in range(dim):
                if len(couple) > 0:
                    couple[entry, d] = 0.0
                if len(tilt) > 0:
                    tilt[entry, d] = 0.0
        out[entry] += share * weight
        if corner >= 0:
            for d in range(dim):
                if len(couple) > 0:
                    couple[entry, d] += weight * places.turn[c, corner, d]
                if len(tilt) > 0:
                    tilt[entry, d] += weight * places.lean[c, corner, d]
    return top


@device
def width_of(s: int, m: int, facets: Ints, row: Ints) -> int:
    """Entries that a row of node s and facet m may take."""
    width: int = row[s + 1] - row[s]
    for corner in range(facets.shape[1]):
        width += row[facets[m, corner] + 1] - row[facets[m, corner]]
    return width


@device
def has_weights(s: int, m: int, facets: Ints, table: Table) -> bool:
    """Return True unless node s or one of facet m has left its points, so that it has no weights."""
    for corner in range(-1, facets.shape[1]):
        p, has = s if corner < 0 else facets[m, corner], False
        for k in entries(table.row, p):
            if table.weight[k] != 0.0:
                has = True
                break
        if not has:
            return False
    return True


@device
def next_slot(s: int, last: int, facet: Ints) -> int:
    """Slot of node s with the lowest facet beyond ``last``; −1 if there is none."""
    following = -1
    for j in range(facet.shape[1]):
        if facet[s, j] > last and (following < 0 or facet[s, j] < facet[s, following]):
            following = j
    slot: int = following
    return slot


@device
def sign_of(first: int, body: int, master: int, normal: Floats) -> float:
    """Return 1 if a row's force counts for the pair's ``first`` body, else −1; of a body with itself, if the
    force acts on what lies lower along the largest component of the normal."""
    if body != master:
        return 1.0 if first == body else -1.0
    largest = 0.0
    for d in range(len(normal)):
        if abs(normal[d]) > abs(largest):
            largest = normal[d]
    return -1.0 if largest > 0.0 else 1.0


@kernel
def assemble(
    rank: Ints, across: bool, ties: float, candidates: Candidates, outline: Surface, pair_of: Ints,
    pair_first: Ints, table: Table, place: Ints, rows: Rows, places: Places, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """A row for each candidate, two where it meets two facets alike; their number, or −1 without room.

    A node counts with its tributary area, or with half of it where its body and the master are of the same
    ``rank`` (body,): each is then slave once. ``across``: only what lies across the normal is a row's area.
    Of two equally close facets both count where the gap is below ``ties`` [m]. ``place`` is scratch
    (:func:`add_point`); without nodes a row has one entry, which is not written. A node that has left its
    points has no row: nothing would take the opposite force.
    """
    c, top, body, dim = 0, 0, outline.body, len(spacing)
    share, normal = scratch.vector(spacing), scratch.vector(spacing)
    other_share, other_normal = scratch.vector(spacing), scratch.vector(spacing)
    n_bodies = len(outline.body_first) - 1
    for s in range(len(body)):
        j = next_slot(s, -1, candidates.facet)
        while j >= 0:
            m, g = candidates.facet[s, j], candidates.gap[s, j]
            following, master = next_slot(s, m, candidates.facet), body_of(m, outline)
            if distance_to(s, m, outline, share, normal, spacing) > 0.0 > g:  # behind its rim
                for d in range(dim):
                    normal[d] = -normal[d]
            other, part = m, 0.0
            if g < ties:
                other, part = equally_close(
                    s, m, share, g, normal, other_share, other_normal, outline, spacing
                )
            for visit in range(2):
                taken = 1.0 - part if visit == 0 else part
                if taken == 0.0 or not has_weights(s, m if visit == 0 else other, outline.facets, table):
                    continue
                if visit == 1:
                    m = other
                    for d in range(dim):
                        share[d], normal[d] = other_share[d], other_normal[d]
                width = width_of(s, m, outline.facets, table.row) if len(place) > 0 else 1
                if c >= len(rows.pair) or top + width > len(rows.dof):
                    return -1
                p = pair_index(pair_of, body[s], master)
                rows.pair[c], rows.identity[c], rows.gap[c] = p, s * n_bodies + master, g
                rows.sign[c] = sign_of(pair_first[p], body[s], master, normal)
                passes = 0.5 if rank[body[s]] == rank[master] else 1.0
                rows.tributary_area[c] = taken * passes * outline.tributary[s]
                rows.area[c] = rows.tributary_area[c]
                if across:
                    rows.area[c] *= share_across(s, normal, outline, spacing)
                places.slave[c], places.facet[c] = s, m
                write_geometry(c, share, normal, outline, rows, places, spacing)
                write_motion(c, outline.displacement, outline.facets, rows, places, rows.motion, spacing)
                rows.start[c] = top
                if len(place) == 0:
                    top += 1
                for corner in range(-1, dim if len(place) > 0 else -1):
                    node, weight = (s, 1.0) if corner < 0 else (outline.facets[m, corner], -share[corner])
                    top = add_point(node, weight, c, corner, top, table, place, rows, places, spacing)
                c += 1
                rows.start[c] = top
            j = following
    return c
