"""Kernels of springs on rows: what they bear, their forces, and what they lose as they change."""

from __future__ import annotations

from mpmfw.kernels import device, kernel
from mpmfw.kernels.contact import carry_over
from mpmfw.kernels.types import Float, Floats, Ints

#: Depth in cells from which a spring grows stiffer: beyond it bodies at the speed of their waves would cross.
LINEAR_TO = 0.25

#: By how much: f = k (d + GROWTH (d − LINEAR_TO h)² / h).
GROWTH = 16.0

#: Share below which a spring hardly bears.
WEAK = 0.1

#: Depth in cells up to which a node that came in by the side of a corner bears at once where a face takes it.
SHALLOW = 0.02

#: Relative change of a loaded spring's share that is let be.
NOISE = 0.02


@device
def normal_force(k: Float, depth: Float, limit: Float) -> Float:
    """Force of a spring of stiffness k at a depth [N/m]; ``limit`` is the depth from which it grows stiffer [m]."""
    if depth <= limit:
        return k * depth
    over = depth - limit
    return k * (depth + GROWTH * LINEAR_TO * over * over / limit)


@device
def spring_energy(k: Float, depth: Float, limit: Float) -> Float:
    """Work that pressing it took [J/m]."""
    if depth <= limit:
        return 0.5 * k * depth * depth
    over = depth - limit
    return k * (0.5 * depth * depth + GROWTH * LINEAR_TO * over * over * over / (3.0 * limit))


@device
def tangent_stiffness(k: Float, depth: Float, limit: Float) -> Float:
    """df/dd [N/m²]."""
    if depth <= limit:
        return k
    return k * (1.0 + 2.0 * GROWTH * LINEAR_TO * (depth - limit) / limit)


@device
def entered(gap: Float, came: Float, cell_size: Float) -> Float:
    """Rest gap of a new spring, whose node ``came`` so much nearer in the last step [m].

    A node that is deeper than it came in by the face has come in by a side, where no segment faced it; a spring loaded to
    that depth at once would make energy of nothing. It has the force of what it came.
    """
    if -gap > max(came, 0.0) + SHALLOW * cell_size:
        return gap + max(came, 0.0)
    return 0.0


@device
def carried_over(
    part: Float, kept: Float, rest: Float, slid: Float, gap: Float, cell_size: Float
) -> tuple[Float, Float]:
    """Share and rest gap of a loaded spring whose share was ``kept`` and would be ``part``.

    Where corners meet the normal jumps, and a spring that became stiffer while it is loaded would make energy of
    nothing. One that grows keeps its force, and so loses energy; one that shrinks keeps its rest, and loses some too.
    Small changes are let be, so that noise does not let bodies at rest creep into one another. A rest fades over a cell of
    sliding: nodes that come in by a corner would hold less than others for good. A node that came in by the side, with
    next to no share, and is shallow when a face takes it, has half of its length under that face: half of its force acts
    at once.
    """
    share, left = kept, max(max(1.0 - abs(slid) / cell_size, 0.0) * rest, gap)
    if kept < WEAK < part and gap > -SHALLOW * cell_size:
        share, left = part, 0.5 * gap
    elif part > kept * (1.0 + NOISE):
        share, left = part, gap + (left - gap) * kept / part
    elif part < kept * (1.0 - NOISE):
        share = part
    return share, left


@device
def along_and_across(c: int, motion: Floats, normal: Floats) -> tuple[Float, Float]:
    """Part of a row's motion along its normal, and length of the rest."""
    along, square = 0.0, 0.0
    for d in range(normal.shape[1]):
        along += motion[c, d] * normal[c, d]
        square += motion[c, d] * motion[c, d]
    return along, max(square - along * along, 0.0) ** 0.5


@device
def end_of(c: int, count: int, identity: Ints) -> int:
    """The row behind those that have the identity of row c, the first of them."""
    e = c + 1
    while e < count and identity[e] == identity[c]:
        e += 1
    return e


@kernel
def set_springs(
    count: int, pair: Ints, identity: Ints, before: Ints, gap: Floats, area: Floats, whole: Floats, normal: Floats,
    motion: Floats, modulus: Floats, stiffest: float, cell_size: float, linear_to: float, begins: bool,
    old_count: int, old_identity: Ints, old_gap: Floats, old_bears: Floats, old_rest: Floats,
    bears: Floats, rest: Floats, k: Floats, tangent_k: Floats,
) -> None:  # fmt: skip
    """Area that bears, rest gap and stiffness of every row; ``modulus`` is κ M / h of each pair.

    A place keeps what it bore, as :func:`carried_over` says, shared by its rows as their areas are. In the step that ``begins``
    the run bodies overlap as the scene has them.
    """
    c = 0
    while c < count:
        e = end_of(c, count, identity)
        part, total, free = 0.0, 0.0, 0.0
        for i in range(c, e):
            part += area[i]
            total += whole[i]
        share, o = part / total, before[c]
        if o >= 0 and old_gap[o] < 0.0 and gap[c] < 0.0:
            kept = 0.0
            for i in range(o, end_of(o, old_count, old_identity)):
                kept += old_bears[i]
            _, slid = along_and_across(c, motion, normal)
            share, free = carried_over(share, kept / total, old_rest[o], slid, gap[c], cell_size)
        elif not begins:
            came, _ = along_and_across(c, motion, normal)
            free = entered(gap[c], -came, cell_size)
        for i in range(c, e):
            bears[i] = share * total * (area[i] / part if part > 0.0 else whole[i] / total)
            rest[i] = free
            k[i] = modulus[pair[i]] * bears[i]
            tangent_k[i] = stiffest * k[i]
            if gap[i] < -linear_to:
                tangent_k[i] = stiffest * tangent_stiffness(k[i], free - gap[i], linear_to)
        c = e


@device
def carried_force(
    c: int, o: int, old_count: int, old_identity: Ints, old_normal: Floats, old_tangential: Floats, share: Float,
    normal: Floats, out: Floats,
) -> None:  # fmt: skip
    """Tangential force that the place of row c had [N/m], turned into its plane, into row c of ``out``, times ``share``."""
    dim = normal.shape[1]
    for d in range(dim):
        out[c, d] = 0.0
    if o >= 0:
        for i in range(o, end_of(o, old_count, old_identity)):
            carry_over(old_tangential, i, old_normal, normal, c, out[c], dim)
    for d in range(dim):
        out[c, d] *= share


@device
def return_to_cone(c: int, limit: Float, k_t: Float, trial: Floats) -> tuple[Float, Float]:
    """Shorten row c of the ``trial`` force to μ f_n [N/m]; the work that slip takes, and the energy kept [J/m]."""
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


@kernel
def spring_forces(
    count: int, pair: Ints, identity: Ints, before: Ints, gap: Floats, normal: Floats, motion: Floats,
    bears: Floats, rest: Floats, stiffness: Floats, dashpot: float, friction: Floats, tangential_ratio: float,
    linear_to: float, old_count: int, old_identity: Ints, old_gap: Floats, old_normal: Floats,
    tangential: Floats, old_tangential: Floats,
    force: Floats, energy: Floats, frictional_work: Floats, damping_work: Floats, spring_work: Floats,
) -> None:  # fmt: skip
    """f = f_n n + f_t of every row that overlaps; ``tangential`` has no rows where there is no friction.

    f_t is the last step's, less k_t times the slip since; at first contact only the part of the step counts that was spent
    in penetration. The pairs' works are added to, their energies written. What slip takes is no loss of the springs.
    """
    dim = normal.shape[1]
    energy[:] = 0.0
    for c in range(count):
        for d in range(dim):
            force[c, d] = 0.0
        if gap[c] >= 0.0:
            if len(tangential) > 0:
                for d in range(dim):
                    tangential[c, d] = 0.0
            continue
        p, k, o = pair[c], stiffness[c], before[c]
        known = o >= 0 and old_gap[o] < 0.0
        depth = max(rest[c] - gap[c], 0.0)
        f_n = normal_force(k, depth, linear_to)
        energy[p] += spring_energy(k, depth, linear_to)
        approach, _ = along_and_across(c, motion, normal)
        if dashpot > 0.0:
            held = max(-min(dashpot * k, 2.0 * k) * approach, -f_n)
            f_n += held
            damping_work[p] += max(-held * approach, 0.0)
        for d in range(dim):
            force[c, d] = f_n * normal[c, d]
        if len(tangential) > 0:
            first, total = c, 0.0
            while first > 0 and identity[first - 1] == identity[c]:
                first -= 1
            for i in range(first, end_of(first, count, identity)):
                total += bears[i]
            share = bears[c] / total if total > 0.0 else 0.0
            carried_force(
                c,
                o if known else -1,
                old_count,
                old_identity,
                old_normal,
                old_tangential,
                share,
                normal,
                tangential,
            )
            slipped = min(1.0, gap[c] / approach) if not known and approach < 0.0 else 1.0
            k_t = tangential_ratio * k
            for d in range(dim):
                tangential[c, d] -= k_t * slipped * (motion[c, d] - approach * normal[c, d])
            lost, kept = return_to_cone(c, friction[p] * f_n, k_t, tangential)
            frictional_work[p] += lost
            spring_work[p] -= lost
            energy[p] += kept
            spring_work[p] -= kept
            for d in range(dim):
                force[c, d] += tangential[c, d]


@kernel
def add_losses(
    count: int, identity: Ints, gap: Floats, rest: Floats, stiffness: Floats,
    old_count: int, old_pair: Ints, old_identity: Ints, old_gap: Floats, old_normal: Floats, old_rest: Floats,
    old_stiffness: Floats, moved: Floats, old_tangential: Floats, tangential_ratio: float, linear_to: float, work: Floats,
) -> None:  # fmt: skip
    """Add to every pair's ``work`` [J/m] the energy of the last step's springs, where they are now, less that of today's.

    A spring whose row moved by Δu has the gap g + n·Δu; what it is now beyond that is a change of the spring: of its area,
    its rest, its facet, or its end. A tangential spring did the work f_t·Δu meanwhile. Energy of today's tangential springs and
    what friction took are no losses (:func:`spring_forces`). A new normal spring changes nothing, since its gap was zero.
    """
    c = 0
    for o in range(old_count):
        if old_gap[o] >= 0.0:
            continue
        k, apart, slip, square = old_stiffness[o], old_gap[o], 0.0, 0.0
        for d in range(old_normal.shape[1]):
            apart += old_normal[o, d] * moved[o, d]
            if len(old_tangential) > 0:
                slip += old_tangential[o, d] * moved[o, d]
                square += old_tangential[o, d] * old_tangential[o, d]
        lost = spring_energy(k, max(old_rest[o] - apart, 0.0), linear_to)
        if k > 0.0 and square > 0.0:
            lost += 0.5 * square / (tangential_ratio * k) - slip
        while c < count and identity[c] < old_identity[o]:
            c += 1
        i = c
        while (
            i < count
            and identity[i] == old_identity[o]
            and (o == 0 or old_identity[o - 1] != old_identity[o])
        ):
            if gap[i] < 0.0:
                lost -= spring_energy(stiffness[i], max(rest[i] - gap[i], 0.0), linear_to)
            i += 1
        work[old_pair[o]] += lost
