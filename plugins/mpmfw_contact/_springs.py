"""Springs that grow stiffer with their depth, and that lose energy as they change."""

from __future__ import annotations

from mpmfw.contact.springs import SpringArrays, approach_of, end_of, first_of
from mpmfw.kernels import device, kernel
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.types import Float, Floats

#: Depth in cells from which a spring grows stiffer: bodies at the speed of their waves would cross.
LINEAR_TO = 0.25

#: By how much: f = k (d + GROWTH (d − l)² / l) beyond that depth l.
GROWTH = 4.0

#: Share below which a spring hardly carries force.
WEAK = 0.1

#: Depth in cells up to which a node that came in by the side of a corner bears at once where a face takes it.
SHALLOW = 0.01

#: Relative change of a loaded spring's share that is ignored.
NOISE = 0.02


class ChangingSprings(SpringArrays):
    """Arrays of springs that change."""

    rest: Floats  #: (n,) gap without force [m]
    moved: Floats  #: (n, dim) motion over the step [m]


@device
def normal_force(k: Float, depth: Float, limit: Float) -> Float:
    """Force of a spring of stiffness k at a depth [N/m]; it grows stiffer from the depth ``limit`` [m]."""
    if depth <= limit:
        return k * depth
    over = depth - limit
    return k * (depth + GROWTH * over * over / limit)


@device
def spring_energy(k: Float, depth: Float, limit: Float) -> Float:
    """Work that pressing it took [J/m]."""
    if depth <= limit:
        return 0.5 * k * depth * depth
    over = depth - limit
    return k * (0.5 * depth * depth + GROWTH * over * over * over / (3.0 * limit))


@device
def tangent_stiffness(k: Float, depth: Float, limit: Float) -> Float:
    """df/dd [N/m²]."""
    if depth <= limit:
        return k
    return k * (1.0 + 2.0 * GROWTH * (depth - limit) / limit)


@device
def new_rest(gap: Float, approached: Float) -> Float:
    """Rest gap of a new spring, whose node ``approached`` so much in the last step [m]: a deeper node came in
    by the side, and a spring loaded to its depth at once would make energy of nothing."""
    return min(gap + max(approached, 0.0), 0.0)


@device
def changed_spring(
    part: Float, old_part: Float, rest: Float, slid: Float, gap: Float, cell_size: Float
) -> tuple[Float, Float]:
    """Share and rest gap of a loaded spring whose share was ``old_part`` and would be ``part``.

    A spring that became stiffer while it is loaded would make energy of nothing. One that grows keeps its
    force, one that shrinks its rest: both lose energy. Small changes are ignored, so that bodies at rest do
    not creep into one another. A rest fades over a cell of sliding, or nodes that come in by a corner would
    hold less for good. A node that came in by the side with next to no share, and is shallow when a face
    takes it, is half under that face: half of its force acts at once.
    """
    share, left = old_part, max(max(1.0 - abs(slid) / cell_size, 0.0) * rest, gap)
    if old_part < WEAK < part and gap > -SHALLOW * cell_size:
        share, left = part, 0.5 * gap
    elif part > old_part * (1.0 + NOISE):
        share, left = part, gap + (left - gap) * old_part / part
    elif part < old_part * (1.0 - NOISE):
        share = part
    return share, left


@kernel
def set_springs(
    rows: Rows, count: int, own: ChangingSprings, old: Rows, old_count: int, old_own: ChangingSprings,
    modulus: Floats, stiffest: float, cell_size: float, linear_to: float, begins: bool, mean_gaps: bool,
) -> None:  # fmt: skip
    """Effective area, rest gap and stiffness of every row; ``modulus`` is κ M / h of each pair.

    A place keeps what it bore, as :func:`changed_spring` says, shared by its rows as their areas are. In
    the step that ``begins`` the run bodies overlap as the scene has them. ``mean_gaps``, which change as
    points enter and leave, change the depth by the motion of the row alone.
    """
    c = 0
    while c < count:
        e = end_of(c, count, rows.identity)
        part, total, free = 0.0, 0.0, 0.0
        for i in range(c, e):
            part += rows.area[i]
            total += rows.tributary_area[i]
        share, o, gap = part / total, rows.previous[c], rows.gap[c]
        along, square = approach_of(c, rows), 0.0
        for d in range(rows.motion.shape[1]):
            square += rows.motion[c, d] * rows.motion[c, d]
        across = max(square - along * along, 0.0) ** 0.5
        if o >= 0 and old.gap[o] < 0.0 and gap < 0.0:
            bore = 0.0
            for i in range(o, end_of(o, old_count, old.identity)):
                bore += old_own.effective_area[i]
            rest = old_own.rest[o]
            if mean_gaps:
                rest += gap - old.gap[o]
                for d in range(rows.motion.shape[1]):
                    rest -= old.normal[o, d] * old_own.moved[o, d]
                rest = min(rest, 0.0)
            share, free = changed_spring(share, bore / total, rest, across, gap, cell_size)
        elif not begins:
            free = new_rest(gap, -along)
        for i in range(c, e):
            own.effective_area[i] = (
                share * total * (rows.area[i] / part if part > 0.0 else rows.tributary_area[i] / total)
            )
            own.rest[i] = free
            own.k[i] = modulus[rows.pair[i]] * own.effective_area[i]
            own.limit_k[i] = stiffest * own.k[i]
            if rows.gap[i] < -linear_to:
                own.limit_k[i] = stiffest * tangent_stiffness(own.k[i], free - rows.gap[i], linear_to)
        c = e


@kernel
def add_losses(
    rows: Rows, count: int, own: ChangingSprings, old: Rows, old_count: int, old_own: ChangingSprings,
    linear_to: float, work: Floats,
) -> None:  # fmt: skip
    """Add to every pair's ``work`` [J/m] the energy of the last step's springs, where they are now, less that
    of this step's.

    A spring whose row moved by Δu has the gap g + n·Δu; any other change is of its area, rest or facet, or
    its end. A tangential spring did the work f_t·Δu meanwhile. Friction and today's tangential springs are
    subtracted by :func:`mpmfw.contact.springs.add_friction`.
    """
    c = 0
    for o in range(old_count):
        if old.gap[o] >= 0.0:
            continue
        k, gap, slip, square = old_own.k[o], old.gap[o], 0.0, 0.0
        for d in range(old.normal.shape[1]):
            gap += old.normal[o, d] * old_own.moved[o, d]
            if len(old_own.tangential) > 0:
                slip += old_own.tangential[o, d] * old_own.moved[o, d]
                square += old_own.tangential[o, d] * old_own.tangential[o, d]
        lost = spring_energy(k, max(old_own.rest[o] - gap, 0.0), linear_to)
        if old_own.k_t[o] > 0.0 and square > 0.0:
            lost += 0.5 * square / old_own.k_t[o] - slip
        while c < count and rows.identity[c] < old.identity[o]:
            c += 1
        i = c
        while i < count and rows.identity[i] == old.identity[o] and first_of(o, old.identity) == o:
            if rows.gap[i] < 0.0:
                lost -= spring_energy(own.k[i], max(own.rest[i] - rows.gap[i], 0.0), linear_to)
            i += 1
        work[old.pair[o]] += lost
