"""Operators on rows of contact: B v, Bᵀ f, the bound of B M⁻¹ Bᵀ K; sums and indices of pairs."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels._struct import Struct
from mpmfw.kernels.types import Float, Floats, Ints


class Rows(Struct):
    """The rows of a step: n places where two bodies may touch, and the m entries of their operator B.

    B v is the velocity of a row's first side as seen from its second, ``normal`` points from the second to
    the first: along it the gap grows, and the force on the first side pushes apart. Rows ascend by
    ``identity``; those of one identity are one place that meets two facets alike.
    """

    pair: Ints  #: (n,) index of the pair
    identity: Ints  #: (n,) which place against which body: the key of the row's history
    previous: Ints  #: (n,) first row of the last step with this identity; −1 without one
    sign: Floats  #: (n,) 1 where the first side is the pair's first body, else −1
    gap: Floats  #: (n,) signed, negative where the bodies overlap [m]; 0 where none is measured
    area: Floats  #: (n,) tributary area across the normal [m^(dim−1)]
    tributary_area: Floats  #: (n,) of the place, whatever its direction [m^(dim−1)]
    normal: Floats  #: (n, dim) unit vector
    motion: Floats  #: (n, dim) B v Δt over the last step [m]
    #: (n,) angle by which both sides turned about the normal over the last step [rad]; (0,) if unknown, and
    #: in 2D
    spin: Floats
    friction: Floats  #: (n,) μ: along its plane a row holds μ N + a; (0,) where no pair has friction
    #: (n,) a [N m^(dim−3)], an impulse in an impulse law; (0,) where nothing holds without a normal force
    cohesion: Floats
    force: Floats  #: (n, dim) on the first side, the law's [N m^(dim−3)]; an impulse law's impulse
    start: Ints  #: (n + 1,) entries of row c are ``start[c]:start[c + 1]``
    dof: Ints  #: (m,) flat grid node
    weight: Floats  #: (m,) weight in B; the sum over a row is 0
    #: (m, dim) c in the tangent plane: a force f acts along the normal by c·f, for its moment, or (0, dim)
    couple: Floats
    tilt: Floats  #: (m, dim) by which a normal force of 1 acts along the facet; (0, dim) without
    #: (k, dim, dim + 1, dim) velocities of a rigid body's points by a unit impulse along each axis on one of
    #: them, the last k nodes [1/kg]; (0, …) without free rigid bodies, and in force laws
    response: Floats


class Records(Struct):
    """What contact did to every pair, written by kernels and read at outputs; in 2D per metre."""

    impulse: Floats  #: (pair, dim) on the pair's first body [N s], added up
    friction_impulse: Floats  #: (pair, dim) its part in the rows' tangent planes [N s], added up
    frictional_work: Floats  #: (pair,) dissipated by friction [J], added up
    damping_work: Floats  #: (pair,) dissipated by dashpots [J], added up
    energy: Floats  #: (pair,) stored in springs [J]
    count: Floats  #: (pair,) places where a force acts


@device
def slip_limit(rows: Rows, c: int, normal_force: Float) -> Float:
    """μ N + a of row c, the largest tangential force beside ``normal_force``; or impulse beside impulse."""
    bound = rows.friction[c] * normal_force if len(rows.friction) > 0 else 0.0
    return bound + (rows.cohesion[c] if len(rows.cohesion) > 0 else 0.0)


@device
def acts(c: int, rows: Rows) -> bool:
    """Return True if row c has a force."""
    force = False
    for d in range(rows.force.shape[1]):
        force = force or rows.force[c, d] != 0.0
    return force


@kernel
def match_rows(rows: Rows, count: int, old: Rows, old_count: int) -> float:
    """Write the index of the first row of the last step with the same identity, −1 without one; both ascend.
    Return the least gap [m]."""
    o, least = 0, math.inf
    for c in range(count):
        least = min(least, rows.gap[c])
        while o < old_count and old.identity[o] < rows.identity[c]:
            o += 1
        rows.previous[c] = o if o < old_count and old.identity[o] == rows.identity[c] else -1
    return least


@device
def row_velocity(c: int, rows: Rows, velocity: Floats, out: Floats, spacing: tuple[float, ...]) -> None:
    """(B v)_c = Σ w v + Σ c (n·v) of row c with the nodes' ``velocity`` (n_nodes, dim) [m/s], into
    ``out``."""
    dim = len(spacing)
    for d in range(dim):
        out[d] = 0.0
    for k in range(rows.start[c], rows.start[c + 1]):
        i, along = rows.dof[k], 0.0
        for d in range(dim):
            out[d] += rows.weight[k] * velocity[i, d]
            along += rows.normal[c, d] * velocity[i, d]
        if len(rows.couple) > 0:
            for d in range(dim):
                out[d] += rows.couple[k, d] * along


@kernel
def relative_motion(
    rows: Rows, count: int, velocity: Floats, scale: float, out: Floats, spacing: tuple[float, ...]
) -> None:
    """``scale`` B v of every row, into ``out`` (n, dim)."""
    motion = scratch.vector(spacing)
    for c in range(count):
        row_velocity(c, rows, velocity, motion, spacing)
        for d in range(len(spacing)):
            out[c, d] = scale * motion[d]


@device
def add_force(
    c: int, force: Floats, rows: Rows, mass: Floats, out: Floats, spacing: tuple[float, ...]
) -> None:
    """out_i += w f + (c·f) n + (f·n) t of row c's nodes: Bᵀ f, t the tilt where a method varies the normal
    (eq. 7 of [H17]). A ``mass`` of nodes divides it, and leaves out those that have none; rigid bodies move
    as a whole."""
    dim, along = len(spacing), 0.0
    first_rigid = len(out) - len(rows.response) if len(mass) > 0 else len(out)
    for d in range(dim):
        along += force[d] * rows.normal[c, d]
    for k in range(rows.start[c], rows.start[c + 1]):
        i, turned = rows.dof[k], 0.0
        divisor = mass[i] if len(mass) > 0 else 1.0
        if divisor <= 0.0:
            continue
        if len(rows.couple) > 0:
            for d in range(dim):
                turned += rows.couple[k, d] * force[d]
        for d in range(dim):
            nodal = rows.weight[k] * force[d] + turned * rows.normal[c, d]
            if len(rows.tilt) > 0:
                nodal += along * rows.tilt[k, d]
            if i < first_rigid:
                out[i, d] += nodal / divisor
                continue
            point = i - first_rigid
            body = i - point % (dim + 1)
            for q in range(dim + 1):
                for e in range(dim):
                    out[body + q, e] += rows.response[point, d, q, e] * nodal


@kernel
def add_row_forces(
    rows: Rows, count: int, mass: Floats, node_force: Floats, spacing: tuple[float, ...]
) -> None:
    """f_i += Bᵀ f of all rows; ``mass`` has no nodes (:func:`add_force`)."""
    force = scratch.vector(spacing)
    for c in range(count):
        if acts(c, rows):
            for d in range(len(spacing)):
                force[d] = rows.force[c, d]
            add_force(c, force, rows, mass, node_force, spacing)


@kernel
def couplings(
    rows: Rows, count: int, stiffness: Floats, node_mass: Floats, node_sum: Floats, out: Floats
) -> float:
    """Row sums Σ_i |b_ci| (Σ_d k_d |b_di|) / m_i of B M⁻¹ Bᵀ K into ``out`` (n,), and the largest, which
    bounds λ_max (Gershgorin).

    With k = 1 and 0 it is the inverse of a row's mass where others share its nodes. ``node_sum`` is
    scratch, zero on entry and on return; nodes without mass do not count.
    """
    for c in range(count):
        if stiffness[c] != 0.0:
            for k in range(rows.start[c], rows.start[c + 1]):
                node_sum[rows.dof[k]] += stiffness[c] * abs(rows.weight[k])
    largest = 0.0
    for c in range(count):
        total = 0.0
        for k in range(rows.start[c], rows.start[c + 1]):
            i = rows.dof[k]
            if node_mass[i] > 0.0:
                total += abs(rows.weight[k]) * node_sum[i] / node_mass[i]
        out[c] = total
        largest = max(largest, total)
    for c in range(count):
        for k in range(rows.start[c], rows.start[c + 1]):
            node_sum[rows.dof[k]] = 0.0
    return largest


@kernel
def rigid_couplings(
    rows: Rows, count: int, active: Floats, direction: Floats, mass: Floats, velocity: Floats, out: Floats,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Inverse masses along ``direction`` e (n, dim) of ``active`` rows on free rigid bodies, into ``out``:
    max(Σ_d a_cd, ½ Σ_d p_cd) over active rows d, with a_cd = e_c·B_c M⁻¹ B_dᵀ e_d.

    p_cd ≥ a_cd = Σ_i m_i v_ci·v_di, v_c = M⁻¹ B_cᵀ e_c, has the products above 0 alone. Rows that approach
    alike are stopped at once; impulses J_c = u_c / out_c ≥ 0 give no energy, as Jᵀ A J ≤ Σ_c J_c² Σ_d p_cd.
    ``velocity`` (3, n_nodes, dim) is scratch, zero on entry: v_c, Σ_d v_d and its components above 0.
    """
    dim, first_rigid = len(spacing), len(mass) - len(rows.response)
    push, moved = scratch.vector(spacing), scratch.vector(spacing)
    own, total, above = velocity[0], velocity[1], velocity[2]
    for summed in (False, True):
        for c in range(count):
            if active[c] == 0.0:
                continue
            for d in range(dim):
                push[d] = direction[c, d]
            add_force(c, push, rows, mass, own, spacing)
            free, along, positive = False, 0.0, 0.0
            for k in range(rows.start[c], rows.start[c + 1]):
                point, rigid = rows.dof[k] - first_rigid, rows.dof[k] >= first_rigid
                first = first_rigid + point - (point % (dim + 1) if rigid else 0)
                free = free or (rigid and mass[first] > 0.0)
                for i in range(first, first + (dim + 1 if rigid else 1)):
                    for d in range(dim):
                        v, own[i, d] = own[i, d], 0.0
                        if summed:
                            positive += mass[i] * v * (above[i, d] if v > 0.0 else total[i, d] - above[i, d])
                        else:
                            total[i, d] += v
                            above[i, d] += max(v, 0.0)
            if summed and free and positive > 0.0:
                row_velocity(c, rows, total, moved, spacing)
                for d in range(dim):
                    along += moved[d] * direction[c, d]
                out[c] = max(along, 0.5 * positive)


@kernel
def add_records(rows: Rows, count: int, scale: float, records: Records, spacing: tuple[float, ...]) -> None:
    """Add ``scale`` Σ f on every pair's first body and its tangential part to the impulses; count the
    places with a force."""
    dim = len(spacing)
    records.count[:] = 0.0
    last = -1
    for c in range(count):
        p, along = rows.pair[c], 0.0
        for d in range(dim):
            along += rows.normal[c, d] * rows.force[c, d]
        for d in range(dim):
            records.impulse[p, d] += rows.sign[c] * scale * rows.force[c, d]
            tangential = rows.force[c, d] - along * rows.normal[c, d]
            records.friction_impulse[p, d] += rows.sign[c] * scale * tangential
        if rows.identity[c] != last and acts(c, rows):
            records.count[p] += 1.0
            last = rows.identity[c]


@device
def add_turned(vector: Floats, o: int, old: Rows, c: int, rows: Rows, out: Floats) -> None:
    """Turn ``vector[o]`` (n, dim) of row o of the last step into the tangent plane of row c, and add it to
    ``out[c]``.

    The turn is the least that takes the old normal into the new: f − (f·n) / (1 + n·n_old) (n + n_old),
    and in space, if rows have a ``spin``, about the new normal as far as the surfaces turned: f cos θ + n
    × f sin θ.
    """
    cosine, along = 0.0, 0.0
    for d in range(out.shape[1]):
        cosine += rows.normal[c, d] * old.normal[o, d]
        along += rows.normal[c, d] * vector[o, d]
    share = along / max(1.0 + cosine, 1e-12)
    if len(rows.spin) == 0:
        for d in range(out.shape[1]):
            out[c, d] += vector[o, d] - share * (rows.normal[c, d] + old.normal[o, d])
        return
    normal, c_turn, s_turn = rows.normal, math.cos(rows.spin[c]), math.sin(rows.spin[c])
    for d in range(3):
        e, f = (d + 1) % 3, (d + 2) % 3
        in_plane = vector[o, d] - share * (normal[c, d] + old.normal[o, d])
        ahead = vector[o, e] - share * (normal[c, e] + old.normal[o, e])
        behind = vector[o, f] - share * (normal[c, f] + old.normal[o, f])
        out[c, d] += c_turn * in_plane + s_turn * (normal[c, e] * behind - normal[c, f] * ahead)


def pair_table(first: Ints, second: Ints) -> Ints:
    """Table that :func:`pair_index` reads of the pairs' bodies (n_pairs,): keys that ascend, and the
    pairs' indices."""
    key = (np.minimum(first, second) << 32) | np.maximum(first, second)
    order = np.argsort(key)
    return np.ascontiguousarray(np.stack([key[order], order], axis=1))


@device
def pair_index(pair_of: Ints, a: int, b: int) -> int:
    """Index of the pair of bodies a and b, in either order; −1 for none."""
    key = (min(a, b) << 32) | max(a, b)
    low, high = 0, len(pair_of)
    while low < high:
        middle = (low + high) // 2
        if pair_of[middle, 0] < key:
            low = middle + 1
        else:
            high = middle
    index: int = pair_of[low, 1] if low < len(pair_of) and pair_of[low, 0] == key else -1
    return index
