"""Largest eigenvalue of the contact operator, bounded from above, for the stable time step."""

from __future__ import annotations

import math

from mpmfw.kernels import device, kernel
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw_contact.penalty.spring import tangent_stiffness

#: Share below which a spring hardly bears.
WEAK = 0.1

#: Depth in cells up to which a node that came in by the side of a corner bears at once where a face takes it.
SHALLOW = 0.02

#: Relative change of a loaded spring's share that is let be.
NOISE = 0.02


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
    displacement: Floats,
    coordinate: Floats,
    normal: Floats,
    gap: Floats,
    cell_size: float,
    old_master: Ints,
    old_share: Floats,
    old_rest: Floats,
    begins: bool,
    share: Floats,
    rest: Floats,
    stiffness: Floats,
) -> None:
    """k = κ M l_trib / h of every candidate; ``node_factor`` is κ l_trib / h, ``modulus`` M of each body.

    Where ``share`` and ``rest`` have nodes, l_trib is only the part of the node's tributary length that lies across the
    contact's normal: at a corner the segment round it carries none of the face's pressure. ``rest`` is the gap at which
    the spring has no force (:func:`carried_over`, :func:`entered`). In the step that ``begins`` the run, bodies overlap as
    the scene has them.
    """
    for s in range(len(body)):
        for j in range(slots):
            stiffness[s, j] = 0.0
            if segment[s, j] >= 0:
                softer = min(modulus[body[s]], modulus[master[s, j]])
                part, factor = 1.0, node_factor[s] * softer
                if len(share) > 0:
                    e_x, e_y = normal[s, j, 0], normal[s, j, 1]
                    part = share_across(s, e_x, e_y, position, following, previous)
                    g, r, known = gap[s, j], 0.0, begins
                    for i in range(slots):
                        if old_master[s, i] == master[s, j] and g < 0.0:
                            known = True
                            slid = motion(
                                s, segment[s, j], coordinate[s, j], -e_y, e_x, displacement, following
                            )
                            part, r = carried_over(part, old_share[s, i], old_rest[s, i], slid, g, cell_size)
                    if not known:
                        came = -motion(s, segment[s, j], coordinate[s, j], e_x, e_y, displacement, following)
                        r = entered(g, came, cell_size)
                    share[s, j], rest[s, j] = part, r
                stiffness[s, j] = part * factor


@device
def motion(s: int, m: int, xi: Float, e_x: Float, e_y: Float, displacement: Floats, following: Ints) -> Float:
    """Motion of node s along e, seen from the point ξ of segment m, in the last step [m]."""
    e, total = following[m], 0.0
    for d in range(2):
        along = e_x if d == 0 else e_y
        total += along * (displacement[s, d] - (1.0 - xi) * displacement[m, d] - xi * displacement[e, d])
    return total


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
    gap: Floats,
    rest: Floats,
    stiffness: Floats,
    linear_to: float,
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
    that two passes over the pairs suffice. Springs deeper than ``linear_to`` [m] count with their tangent.
    ``node_stiffness`` is scratch, zero on entry and on return.
    """
    largest = 0.0
    for phase in range(3):
        for s in range(len(segment)):
            for j in range(slots):
                m = segment[s, j]
                if m < 0:
                    continue
                k, xi = stiffness[s, j], coordinate[s, j]
                if gap[s, j] < -linear_to and len(rest) > 0:
                    k = tangent_stiffness(k, rest[s, j] - gap[s, j], linear_to)
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
