"""Operators on rows of contact: B v, Bᵀ f, the bound of B M⁻¹ Bᵀ K, and the sums of every pair.

Row c has the entries ``start[c]:start[c + 1]``: the node ``dof``, its ``weight`` in the relative motion, and ``couple``, a vector
in the tangent plane by which a tangential force acts along the normal, so that its moment is kept where there is a gap.
``couple`` and ``tilt`` without entries are no such effect. The rows ``begin:end`` are worked on.
"""

from __future__ import annotations

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.types import Floats, Ints


@kernel
def match_rows(begin: int, end: int, identity: Ints, old_end: int, old_identity: Ints, before: Ints) -> None:
    """Index of the first row of the last step with the same identity, −1 without one; both ascend."""
    o = 0
    for c in range(begin, end):
        while o < old_end and old_identity[o] < identity[c]:
            o += 1
        before[c] = o if o < old_end and old_identity[o] == identity[c] else -1


@device
def motion_of_row(
    c: int, start: Ints, dof: Ints, weight: Floats, couple: Floats, normal: Floats, velocity: Floats, out: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Σ w v + Σ c (n·v) of one row, into ``out`` (dim,)."""
    dim = len(spacing)
    for d in range(dim):
        out[d] = 0.0
    for k in range(start[c], start[c + 1]):
        i, along = dof[k], 0.0
        for d in range(dim):
            out[d] += weight[k] * velocity[i, d]
            along += normal[c, d] * velocity[i, d]
        if len(couple) > 0:
            for d in range(dim):
                out[d] += couple[k, d] * along


@kernel
def relative_motion(
    begin: int, end: int, start: Ints, dof: Ints, weight: Floats, couple: Floats, normal: Floats, velocity: Floats,
    scale: float, out: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """``scale`` B v of every row, into ``out`` (n, dim)."""
    dim = len(spacing)
    motion = scratch.vector(spacing)
    for c in range(begin, end):
        motion_of_row(c, start, dof, weight, couple, normal, velocity, motion, spacing)
        for d in range(dim):
            out[c, d] = scale * motion[d]


@kernel
def relative_velocity(
    begin: int, end: int, start: Ints, dof: Ints, weight: Floats, couple: Floats, normal: Floats, node_mass: Floats,
    node_momentum: Floats, out: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """B v of every row with v = (m v) / m, into ``out`` (n, dim); nodes without mass stand still."""
    dim = len(spacing)
    for c in range(begin, end):
        for d in range(dim):
            out[c, d] = 0.0
        for k in range(start[c], start[c + 1]):
            i, along = dof[k], 0.0
            inverse = 1.0 / node_mass[i] if node_mass[i] > 0.0 else 0.0
            for d in range(dim):
                out[c, d] += weight[k] * (node_momentum[i, d] * inverse)
                along += normal[c, d] * (node_momentum[i, d] * inverse)
            if len(couple) > 0:
                for d in range(dim):
                    out[c, d] += couple[k, d] * along


@kernel
def add_row_forces(
    begin: int, end: int, start: Ints, dof: Ints, weight: Floats, couple: Floats, tilt: Floats, normal: Floats,
    force: Floats, node_force: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """f_i += Σ_c w f_c + (c·f_c) n + (f_c·n) t: Bᵀ f, with the tilt t of the normal where a method varies it (eq. 7 of [H17])."""
    dim = len(spacing)
    for c in range(begin, end):
        along = 0.0
        acts = False
        for d in range(dim):
            along += force[c, d] * normal[c, d]
            acts = acts or force[c, d] != 0.0
        if not acts:
            continue
        for k in range(start[c], start[c + 1]):
            i, turned = dof[k], 0.0
            if len(couple) > 0:
                for d in range(dim):
                    turned += couple[k, d] * force[c, d]
            for d in range(dim):
                node_force[i, d] += weight[k] * force[c, d] + turned * normal[c, d]
                if len(tilt) > 0:
                    node_force[i, d] += along * tilt[k, d]


@kernel
def couplings(
    begin: int, end: int, start: Ints, dof: Ints, weight: Floats, stiffness: Floats, node_mass: Floats,
    node_sum: Floats, out: Floats,
) -> float:  # fmt: skip
    """Row sums Σ_i |b_ci| (Σ_d k_d |b_di|) / m_i of B M⁻¹ Bᵀ K into ``out`` (n,), and the largest: it bounds λ_max (Gershgorin).

    With k = 1 and 0 it is the inverse of the mass that a row has if others share its nodes. ``node_sum`` is scratch, zero on
    entry and on return; nodes without mass do not count.
    """
    for c in range(begin, end):
        if stiffness[c] != 0.0:
            for k in range(start[c], start[c + 1]):
                node_sum[dof[k]] += stiffness[c] * abs(weight[k])
    largest = 0.0
    for c in range(begin, end):
        total = 0.0
        for k in range(start[c], start[c + 1]):
            if node_mass[dof[k]] > 0.0:
                total += abs(weight[k]) * node_sum[dof[k]] / node_mass[dof[k]]
        out[c] = total
        largest = max(largest, total)
    for c in range(begin, end):
        for k in range(start[c], start[c + 1]):
            node_sum[dof[k]] = 0.0
    return largest


@kernel
def add_records(
    begin: int, end: int, pair: Ints, identity: Ints, sign: Floats, force: Floats, scale: float,
    impulse: Floats, count: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Impulse ``scale`` Σ f on every pair's first body, added, and the number of places with a force.

    Rows of one identity are one place. ``sign`` is −1 where the row's force acts on the pair's second body.
    """
    dim = len(spacing)
    count[:] = 0.0
    last = -1
    for c in range(begin, end):
        acts = False
        for d in range(dim):
            impulse[pair[c], d] += sign[c] * scale * force[c, d]
            acts = acts or force[c, d] != 0.0
        if acts and identity[c] != last:
            count[pair[c]] += 1.0
            last = identity[c]


@device
def carry_over(
    old: Floats, o: int, old_normal: Floats, normal: Floats, c: int, out: Floats, dim: int
) -> None:
    """Turn the tangential vector of row o of the last step into the tangent plane of row c, and add it to ``out`` (dim,).

    The turn is the least that takes the old normal into the new: f − (f·n) / (1 + n·n_old) (n + n_old). In the plane the force
    keeps its sign on the tangent, on a triangle its direction within it.
    """
    cosine, along = 0.0, 0.0
    for d in range(dim):
        cosine += normal[c, d] * old_normal[o, d]
        along += normal[c, d] * old[o, d]
    share = along / max(1.0 + cosine, 1e-12)
    for d in range(dim):
        out[d] += old[o, d] - share * (normal[c, d] + old_normal[o, d])
