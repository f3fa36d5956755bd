"""Kernels of springs on rows: what they bear, their forces, and what they lose as they change."""

from __future__ import annotations

from mpmfw.kernels import Struct, device, kernel
from mpmfw.kernels.contact import Records, Rows, add_turned, slip_bound
from mpmfw.kernels.types import Float, Floats, Ints

#: Depth in cells from which a spring grows stiffer: were it linear, bodies at the speed of their waves would cross.
LINEAR_TO = 0.25

#: By how much: f = k (d + GROWTH (d − l)² / l) beyond that depth l.
GROWTH = 4.0

#: Share below which a spring hardly bears.
WEAK = 0.1

#: Depth in cells up to which a node that came in by the side of a corner bears at once where a face takes it.
SHALLOW = 0.01

#: Relative change of a loaded spring's share that is let be.
NOISE = 0.02


class SpringArrays(Struct):
    """A law's own arrays of n rows."""

    bears: Floats  #: (n,) area that bears [m^(dim−1)]
    rest: Floats  #: (n,) gap without force [m]
    k: Floats  #: (n,) stiffness [N m^(dim−4)]
    tangent_k: Floats  #: (n,) tangent stiffness, at its greatest
    moved: Floats  #: (n, dim) motion over the step [m]
    tangential: Floats  #: (n, dim) tangential force; (0, dim) where there is no friction


@device
def normal_force(k: Float, depth: Float, limit: Float) -> Float:
    """Force of a spring of stiffness k at a depth [N/m]; ``limit`` is the depth from which it grows stiffer [m]."""
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
    """Rest gap of a new spring, whose node ``approached`` so much in the last step [m].

    A node that is deeper than it came in by the face has come in by a side, where no facet faced it; a spring loaded to
    that depth at once would make energy of nothing. It has the force of its approach.
    """
    return min(gap + max(approached, 0.0), 0.0)


@device
def changed_spring(
    part: Float, old_part: Float, rest: Float, slid: Float, gap: Float, cell_size: Float
) -> tuple[Float, Float]:
    """Share and rest gap of a loaded spring whose share was ``old_part`` and would be ``part``.

    Where corners meet the normal jumps, and a spring that became stiffer while it is loaded would make energy of
    nothing. One that grows keeps its force, and so loses energy; one that shrinks keeps its rest, and loses some too.
    Small changes are let be, so that noise does not let bodies at rest creep into one another. A rest fades over a cell of
    sliding: nodes that come in by a corner would hold less than others for good. A node that came in by the side, with
    next to no share, and is shallow when a face takes it, has half of its length under that face: half of its force acts
    at once.
    """
    share, left = old_part, max(max(1.0 - abs(slid) / cell_size, 0.0) * rest, gap)
    if old_part < WEAK < part and gap > -SHALLOW * cell_size:
        share, left = part, 0.5 * gap
    elif part > old_part * (1.0 + NOISE):
        share, left = part, gap + (left - gap) * old_part / part
    elif part < old_part * (1.0 - NOISE):
        share = part
    return share, left


@device
def along_and_across(c: int, rows: Rows) -> tuple[Float, Float]:
    """Part of row c's motion along its normal, and length of the rest."""
    along, square = 0.0, 0.0
    for d in range(rows.normal.shape[1]):
        along += rows.motion[c, d] * rows.normal[c, d]
        square += rows.motion[c, d] * rows.motion[c, d]
    return along, max(square - along * along, 0.0) ** 0.5


@device
def end_of(c: int, count: int, identity: Ints) -> int:
    """The row behind those that have the identity of row c."""
    e = c + 1
    while e < count and identity[e] == identity[c]:
        e += 1
    return e


@device
def first_of(c: int, identity: Ints) -> int:
    """The first row with the identity of row c."""
    while c > 0 and identity[c - 1] == identity[c]:
        c -= 1
    return c


@kernel
def set_springs(
    rows: Rows, count: int, own: SpringArrays, old: Rows, old_count: int, old_own: SpringArrays, modulus: Floats, stiffest: float,
    cell_size: float, linear_to: float, begins: bool,
) -> None:  # fmt: skip
    """Area that bears, rest gap and stiffness of every row; ``modulus`` is κ M / h of each pair.

    A place keeps what it bore, as :func:`changed_spring` says, shared by its rows as their areas are. In the step that ``begins``
    the run bodies overlap as the scene has them.
    """
    c = 0
    while c < count:
        e = end_of(c, count, rows.identity)
        part, total, free = 0.0, 0.0, 0.0
        for i in range(c, e):
            part += rows.area[i]
            total += rows.whole[i]
        share, o, gap = part / total, rows.before[c], rows.gap[c]
        along, across = along_and_across(c, rows)
        if o >= 0 and old.gap[o] < 0.0 and gap < 0.0:
            bore = 0.0
            for i in range(o, end_of(o, old_count, old.identity)):
                bore += old_own.bears[i]
            share, free = changed_spring(share, bore / total, old_own.rest[o], across, gap, cell_size)
        elif not begins:
            free = new_rest(gap, -along)
        for i in range(c, e):
            own.bears[i] = share * total * (rows.area[i] / part if part > 0.0 else rows.whole[i] / total)
            own.rest[i] = free
            own.k[i] = modulus[rows.pair[i]] * own.bears[i]
            own.tangent_k[i] = stiffest * own.k[i]
            if rows.gap[i] < -linear_to:
                own.tangent_k[i] = stiffest * tangent_stiffness(own.k[i], free - rows.gap[i], linear_to)
        c = e


@device
def old_force(
    c: int, o: int, rows: Rows, old: Rows, old_count: int, old_tangential: Floats, share: Float, out: Floats
) -> None:
    """Tangential force that the place of row c had from row ``o`` on [N/m], turned into its plane, into row c of ``out``, times
    ``share``; none where o is negative."""
    for d in range(out.shape[1]):
        out[c, d] = 0.0
    if o >= 0:
        for i in range(o, end_of(o, old_count, old.identity)):
            add_turned(old_tangential, i, old, c, rows, out)
    for d in range(out.shape[1]):
        out[c, d] *= share


@device
def return_to_cone(c: int, limit: Float, k_t: Float, trial: Floats) -> tuple[Float, Float]:
    """Shorten row c of the ``trial`` force to its ``limit`` [N/m]; the work that slip takes, and the energy left [J/m]."""
    dim, square = trial.shape[1], 0.0
    for d in range(dim):
        square += trial[c, d] * trial[c, d]
    size = square**0.5
    held = min(size, limit)
    for d in range(dim):
        trial[c, d] = trial[c, d] * (held / size) if size > limit else trial[c, d]
    if k_t <= 0.0:
        return 0.0, 0.0
    return held * (size - held) / k_t, 0.5 * held * held / k_t


@device
def add_losses(
    rows: Rows, count: int, own: SpringArrays, old: Rows, old_count: int, old_own: SpringArrays, tangential_ratio: float,
    linear_to: float, work: Floats,
) -> None:  # fmt: skip
    """Add to every pair's ``work`` [J/m] the energy of the last step's springs, where they are now, less that of today's.

    A spring whose row moved by Δu has the gap g + n·Δu; what it is now beyond that is a change of the spring: of its area,
    its rest, its facet, or its end. A tangential spring did the work f_t·Δu meanwhile. Energy of today's tangential springs and
    what friction took are no losses (:func:`spring_forces`). A new normal spring changes nothing, since its gap was zero.
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
        if k > 0.0 and square > 0.0:
            lost += 0.5 * square / (tangential_ratio * k) - slip
        while c < count and rows.identity[c] < old.identity[o]:
            c += 1
        i = c
        while i < count and rows.identity[i] == old.identity[o] and first_of(o, old.identity) == o:
            if rows.gap[i] < 0.0:
                lost -= spring_energy(own.k[i], max(own.rest[i] - rows.gap[i], 0.0), linear_to)
            i += 1
        work[old.pair[o]] += lost


@kernel
def spring_forces(
    rows: Rows, count: int, own: SpringArrays, old: Rows, old_count: int, old_own: SpringArrays, tangential_ratio: float,
    dashpot: float, linear_to: float, records: Records, change: Floats,
) -> None:  # fmt: skip
    """f = f_n n + f_t of every row that overlaps; tangential forces have no rows where there is no friction.

    f_t is the last step's, less k_t times the slip since; at first contact only the part of the step counts that was spent
    in penetration. The pairs' works are added to, their energies written. To ``change`` is added what springs lose that change:
    not what slip takes.
    """
    dim, has_friction = rows.normal.shape[1], len(own.tangential) > 0
    records.energy[:] = 0.0
    for c in range(count):
        for d in range(dim):
            rows.force[c, d] = 0.0
            if has_friction:
                own.tangential[c, d] = 0.0
        gap = rows.gap[c]
        if gap >= 0.0:
            continue
        p, k, o = rows.pair[c], own.k[c], rows.before[c]
        if o >= 0 and old.gap[o] >= 0.0:
            o = -1  # no contact then
        depth = max(own.rest[c] - gap, 0.0)
        f_n = normal_force(k, depth, linear_to)
        records.energy[p] += spring_energy(k, depth, linear_to)
        approach, _ = along_and_across(c, rows)
        if dashpot > 0.0:
            held = max(-min(dashpot * k, 2.0 * k) * approach, -f_n)
            f_n += held
            records.damping_work[p] += max(-held * approach, 0.0)
        for d in range(dim):
            rows.force[c, d] = f_n * rows.normal[c, d]
        if has_friction:
            first, total = first_of(c, rows.identity), 0.0
            for i in range(first, end_of(first, count, rows.identity)):
                total += own.bears[i]
            share = own.bears[c] / total if total > 0.0 else 0.0
            old_force(c, o, rows, old, old_count, old_own.tangential, share, own.tangential)
            slipped = min(1.0, gap / approach) if o < 0 and approach < 0.0 else 1.0
            k_t = tangential_ratio * k
            for d in range(dim):
                own.tangential[c, d] -= k_t * slipped * (rows.motion[c, d] - approach * rows.normal[c, d])
            lost, stored = return_to_cone(c, slip_bound(rows, c, f_n), k_t, own.tangential)
            records.frictional_work[p] += lost
            change[p] -= lost
            records.energy[p] += stored
            change[p] -= stored
            for d in range(dim):
                rows.force[c, d] += own.tangential[c, d]
    add_losses(rows, count, own, old, old_count, old_own, tangential_ratio, linear_to, change)
