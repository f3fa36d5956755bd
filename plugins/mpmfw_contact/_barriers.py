"""Kernels of logarithmic barriers: distances, stiffness, forces, and the time until a place would touch."""

from __future__ import annotations

import math

from mpmfw.api.types import Surface
from mpmfw.contact.springs import SpringArrays, approach_of
from mpmfw.contact.surfaces.assembly import Places
from mpmfw.contact.surfaces.outline import hidden
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.contact import Records, Rows
from mpmfw.kernels.facets import read_point
from mpmfw.kernels.surfaces import signed_distance
from mpmfw.kernels.types import Float, Floats, Table

#: Least part of a distance that is left when the stiffness of the step's end is foreseen.
LEFT = 0.25

#: Least part of a place's area that counts at any angle, so that nothing passes a corner.
LEAST_SHARE = 0.1

#: Part of a distance within reach, or of the reach, that a step may use up.
USED = 0.5


class BarrierArrays(SpringArrays):
    """Arrays of barriers; ``limit_k`` is the stiffness at its greatest in the step."""

    distance: Floats  #: (n,) gap, counted from where its pair began [m]


@device
def barrier(s: Float) -> Float:
    """b(s) = −(1 − s)² ln s for 0 < s < 1, beyond that 0."""
    if s >= 1.0:
        return 0.0
    return -(1.0 - s) * (1.0 - s) * math.log(s)


@device
def barrier_slope(s: Float) -> Float:
    """−b'(s), positive."""
    if s >= 1.0:
        return 0.0
    return (1.0 - s) * ((1.0 - s) / s - 2.0 * math.log(s))


@device
def barrier_curvature(s: Float) -> Float:
    """b''(s)."""
    if s >= 1.0:
        return 0.0
    over = (1.0 - s) / s
    return over * (over + 4.0) - 2.0 * math.log(s)


@kernel
def set_barriers(
    rows: Rows, count: int, own: BarrierArrays, modulus: Floats, offset: Floats, reach: float,
    cell_size: float, stiffest: float,
) -> int:  # fmt: skip
    """Write distance and greatest stiffness in the step of every row; return the first row whose distance is
    used up, or −1.

    ``modulus`` is κ M / h of each pair, ``offset`` is added to its gaps, and ``stiffest`` is k_t over κ M A /
    reach. The step's end is foreseen from the last motion.
    """
    for c in range(count):
        p = rows.pair[c]
        distance = rows.gap[c] + offset[p]
        own.distance[c], own.limit_k[c] = distance, 0.0
        if distance <= 0.0:
            return c
        approach = approach_of(c, rows)
        own.effective_area[c] = max(rows.area[c], LEAST_SHARE * rows.tributary_area[c])
        ahead = max(distance + min(2.0 * approach, 0.0), LEFT * distance)
        if ahead < reach:
            unit = modulus[p] * (cell_size / reach) * own.effective_area[c]
            own.limit_k[c] = max(barrier_curvature(ahead / reach), stiffest) * unit
    return -1


@kernel
def barrier_forces(
    rows: Rows, count: int, own: BarrierArrays, old_own: BarrierArrays, modulus: Floats, reach: float,
    cell_size: float, tangential_ratio: float, records: Records,
) -> None:  # fmt: skip
    """Write N = −κ M A b'(d / reach) of every row nearer than ``reach``, and the part of its first step."""
    for c in range(count):
        s, o, k = own.distance[c] / reach, rows.previous[c], modulus[rows.pair[c]] * own.effective_area[c]
        if s >= 1.0:
            continue
        own.normal[c], own.k_t[c] = k * cell_size * barrier_slope(s), tangential_ratio * k * cell_size / reach
        records.energy[rows.pair[c]] += k * cell_size * reach * barrier(s)
        approach = approach_of(c, rows)
        if approach < 0.0 and (o < 0 or old_own.distance[o] >= reach):
            own.entered[c] = min(1.0, (own.distance[c] - reach) / approach)


@device
def add_velocity(
    p: int, sign: Float, table: Table, mass: Floats, momentum: Floats, out: Floats,
    spacing: tuple[float, ...]
) -> None:  # fmt: skip
    """Add ``sign`` times the velocity of surface node p to ``out``: Σ N_i(x_p) (m v)_i / m_i."""
    for k in range(table.row[p], table.row[p + 1]):
        i = table.nodes[k]
        if mass[i] != 0.0:
            for d in range(len(spacing)):
                out[d] += sign * table.weight[k] * (momentum[i, d] / mass[i])


@device
def time_to_reach(
    s: int, m: int, share: Floats, normal: Floats, offset: Float, reach: Float, outline: Surface,
    table: Table, mass: Floats, momentum: Floats, spacing: tuple[float, ...],
) -> Float:  # fmt: skip
    """Time in which node s and facet m, as they move, use up :data:`USED` of their distance along ``normal``,
    or of the reach [s].

    No corner of the facet comes past the node sooner. With an ``offset`` surfaces may overlap, and the point
    with the coordinates ``share`` counts.
    """
    dim, least = len(spacing), math.inf
    own, motion = scratch.vector(spacing), scratch.vector(spacing)
    for d in range(dim):
        own[d] = 0.0
    add_velocity(s, 1.0, table, mass, momentum, own, spacing)
    between, approach = offset, 0.0
    for a in range(dim):
        corner, clear, closing = outline.facets[m, a], 0.0, 0.0
        for d in range(dim):
            motion[d] = own[d]
        add_velocity(corner, -1.0, table, mass, momentum, motion, spacing)
        for d in range(dim):
            clear += (outline.position[s, d] - outline.position[corner, d]) * normal[d]
            closing -= motion[d] * normal[d]
        between += share[a] * clear
        approach += share[a] * closing
        if offset == 0.0 and closing > 0.0:
            least = min(least, (clear - (1.0 - USED) * min(clear, reach)) / closing)
    if offset > 0.0 and approach > 0.0:
        least = (between - (1.0 - USED) * min(between, reach)) / approach
    return least


@kernel
def time_to_touch(
    rows: Rows, count: int, places: Places, outline: Surface, table: Table, offset: Floats, reach: float,
    mass: Floats, momentum: Floats, spacing: tuple[float, ...],
) -> float:  # fmt: skip
    """Least :func:`time_to_reach` of all rows, and of the facets beside theirs [s]."""
    least, dim = math.inf, len(spacing)
    x, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    for c in range(count):
        s, m, start = places.slave[c], places.facet[c], offset[rows.pair[c]]
        for d in range(dim):
            share[d], normal[d] = places.share[c, d], rows.normal[c, d]
        least = min(
            least, time_to_reach(s, m, share, normal, start, reach, outline, table, mass, momentum, spacing)
        )
        if start > 0.0:
            continue
        read_point(s, outline.position, x, spacing)
        for a in range(dim):
            beside = outline.neighbours[m, a]
            if hidden(beside, outline.body[s], outline):
                continue
            if signed_distance(x, beside, outline, share, normal, spacing) < 0.0:
                for d in range(dim):
                    normal[d] = -normal[d]
            least = min(
                least,
                time_to_reach(s, beside, share, normal, 0.0, reach, outline, table, mass, momentum, spacing),
            )
    return least
