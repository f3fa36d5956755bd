"""Largest eigenvalue of the contact operator, bounded from above, for the stable time step."""

from __future__ import annotations

import math

from mpmfw.kernels import device, kernel
from mpmfw.kernels.types import Float, Floats, Indices, Ints


@kernel
def spring_stiffness(
    slots: int,
    segment: Ints,
    master: Ints,
    body: Ints,
    node_factor: Floats,
    modulus: Floats,
    position: Floats,
    following: Ints,
    previous: Ints,
    normal: Floats,
    projected: bool,
    gap: Floats,
    shallow: float,
    old_master: Ints,
    old_share: Floats,
    share: Floats,
    stiffness: Floats,
) -> None:
    """k = κ M l_trib / h of every candidate; ``node_factor`` is κ l_trib / h, ``modulus`` M of each two bodies.

    If ``projected``, l_trib is only the part of the node's tributary length that lies across the contact's normal: at a
    corner the segment round it carries none of the face's pressure. A contact deeper than ``shallow`` keeps the share that it
    has: where corners meet the normal jumps, and a loaded spring that changes makes energy of nothing.
    """
    for s in range(len(body)):
        for j in range(slots):
            stiffness[s, j] = 0.0
            if segment[s, j] >= 0:
                share[s, j] = 1.0
                if projected:
                    share[s, j] = share_across(
                        s, normal[s, j, 0], normal[s, j, 1], position, following, previous
                    )
                    for i in range(slots):
                        if old_master[s, i] == master[s, j] and gap[s, j] < -shallow:
                            share[s, j] = old_share[s, i]
                stiffness[s, j] = share[s, j] * node_factor[s] * modulus[body[s], master[s, j]]


@device
def share_across(s: int, e_x: Float, e_y: Float, position: Floats, following: Ints, previous: Ints) -> Float:
    """Of a node's two segments, the part of their length that lies across e_n and faces it; 1 on a flat face."""
    a, b = previous[s], following[s]
    before_x, before_y = position[s, 0] - position[a, 0], position[s, 1] - position[a, 1]
    after_x, after_y = position[b, 0] - position[s, 0], position[b, 1] - position[s, 1]
    length = math.hypot(before_x, before_y) + math.hypot(after_x, after_y)
    return (max(before_x * e_y - before_y * e_x, 0.0) + max(after_x * e_y - after_y * e_x, 0.0)) / length


@kernel
def contact_frequency(
    slots: int,
    segment: Ints,
    coordinate: Floats,
    stiffness: Floats,
    following: Ints,
    row: Ints,
    nodes: Indices,
    weight: Floats,
    node_mass: Floats,
    node_stiffness: Floats,
) -> float:
    """Gershgorin bound of ω² = λ_max(B M⁻¹ Bᵀ K) over all candidate pairs [1/s²].

    Row c of B maps nodal displacement to the gap of pair c; its entries are N_i(x_s) on the slave's field and
    (1−ξ) N_i(x_1) + ξ N_i(x_2) on the master's. Σ_d |(B M⁻¹ Bᵀ K)_cd| ≤ Σ_i |b_ci| (Σ_d k_d |b_di|) / m_i, so
    that two passes over the pairs suffice. ``node_stiffness`` is scratch, zero on entry and on return.
    """
    largest = 0.0
    for phase in range(3):
        for s in range(len(segment)):
            for j in range(slots):
                m = segment[s, j]
                if m < 0:
                    continue
                k, xi = stiffness[s, j], coordinate[s, j]
                total = 0.0
                for end in range(3):
                    point = s if end == 0 else m if end == 1 else following[m]
                    share = 1.0 if end == 0 else 1.0 - xi if end == 1 else xi
                    for entry in range(row[point], row[point + 1]):
                        i = nodes[entry]
                        b = share * weight[entry]
                        if phase == 0:
                            node_stiffness[i] += k * b
                        elif phase == 1:
                            if node_mass[i] > 0.0:
                                total += b * node_stiffness[i] / node_mass[i]
                        else:
                            node_stiffness[i] = 0.0
                largest = max(largest, total)
    return largest


@kernel
def map_to_grid(row: Ints, nodes: Indices, weight: Floats, force: Floats, node_force: Floats) -> None:
    """f_i^cont = Σ_s N_i(x_s) f_s (eq. 11 of [H17])."""
    for s in range(len(force)):
        if force[s, 0] != 0.0 or force[s, 1] != 0.0:
            for k in range(row[s], row[s + 1]):
                for d in range(2):
                    node_force[nodes[k], d] += weight[k] * force[s, d]
