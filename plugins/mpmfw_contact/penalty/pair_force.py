"""The force between a slave node and a master segment (eq. 3-9 of [H17])."""

from __future__ import annotations

import math

from mpmfw.kernels import device, kernel
from mpmfw.kernels.polyline import signed_distance
from mpmfw.kernels.types import Float, Floats, Ints
from mpmfw_contact.penalty.facing import faces
from mpmfw_contact.penalty.pair_table import pair_index
from mpmfw_contact.penalty.spring import normal_force, spring_energy


@device
def normal_rows(e_x: Float, e_y: Float, xi: Float, out: Floats) -> None:
    """N = [e_n, −(1−ξ) e_n, −ξ e_n] on the degrees of freedom (u_s, u_1, u_2), (3, 2): the exact δg_n."""
    for d in range(2):
        e = e_x if d == 0 else e_y
        out[0, d], out[1, d], out[2, d] = e, -(1.0 - xi) * e, -xi * e


@device
def tangential_rows(e_x: Float, e_y: Float, xi: Float, gap: Float, lever: Float, out: Floats) -> None:
    """C_t = T + (g_n / l) P, (3, 2): exact l δξ; without P the pair would leave the moment g_n f_t.

    e_t = (−e_n,y, e_n,x). ``lever`` is (x_2 − x_1)·e_t: the length l, or its share along e_t where the
    closest point is a vertex and e_n is not the segment's normal; so the moment balances there too.
    """
    for d in range(2):
        e_n = e_x if d == 0 else e_y
        e_t = -e_y if d == 0 else e_x
        couple = gap / lever * e_n
        out[0, d], out[1, d], out[2, d] = e_t, -(1.0 - xi) * e_t - couple, -xi * e_t + couple


@device
def tangent_rows(t_x: Float, t_y: Float, out: Floats) -> None:
    """Q = [0, −e_t, e_t], (3, 2), with the segment's own unit tangent: at a vertex any other would leave a
    moment."""
    for d in range(2):
        t = t_x if d == 0 else t_y
        out[0, d], out[1, d], out[2, d] = 0.0, -t, t


@device
def turn_normal(t_x: Float, t_y: Float, gap: Float, q: Floats, n: Floats) -> None:
    """C_n = N − (g_n / l) Q in place of N, as [H17] has it: the normal is varied with the segment."""
    length = math.sqrt(t_x * t_x + t_y * t_y)
    tangent_rows(t_x / length, t_y / length, q)
    for row in range(3):
        for d in range(2):
            n[row, d] -= gap / length * q[row, d]


@device
def relative_motion(rows: Floats, s: int, m: int, end: int, displacement: Floats) -> Float:
    """Σ rows · u over slave node and segment ends [m]: how far the pair moved along the rows in the last step."""
    total = 0.0
    for d in range(2):
        total += (
            rows[0, d] * displacement[s, d]
            + rows[1, d] * displacement[m, d]
            + rows[2, d] * displacement[end, d]
        )
    return total


@device
def stored_force(s: int, touched: int, old_master: Ints, old_tangential: Floats) -> tuple[Float, bool]:
    """Tangential force that node s had with body ``touched`` in the last step [N/m], and whether it had one."""
    stored, known = 0.0, False
    for i in range(old_master.shape[1]):
        if old_master[s, i] == touched:
            stored, known = old_tangential[s, i], True
    return stored, known


@device
def return_to_cone(trial: Float, limit: Float, k_t: Float) -> tuple[Float, Float, Float]:
    """Return mapping: f_t in ±μ f_n [N/m] of the trial force f_t − k_t Δg_t, the work that slip takes, the energy kept [J/m].

    Δg_t = C_tᵀ Δu on the present segment; at first contact only the part of the step that was spent in penetration.
    """
    if k_t <= 0.0:
        return 0.0, 0.0, 0.0
    f_t = min(max(trial, -limit), limit)
    return f_t, abs(f_t) * abs(trial - f_t) / k_t, 0.5 * f_t * f_t / k_t


#: Difference of distances, in lengths of a segment, below which two segments are equally close: what rounding leaves.
TIE = 1e-9


@device
def length_along(a: int, e_x: Float, e_y: Float, position: Floats, following: Ints) -> Float:
    """(x_2 − x_1)·e_t of segment a [m], e_t = (−e_n,y, e_n,x)."""
    b = following[a]
    along: Float = -e_y * (position[b, 0] - position[a, 0]) + e_x * (position[b, 1] - position[a, 1])
    return along


@device
def equally_close(
    s: int, m: int, xi: Float, gap: Float, e_x: Float, e_y: Float, position: Floats, following: Ints, previous: Ints
) -> tuple[int, Float, Float, Float, Float]:  # fmt: skip
    """The neighbour of segment m to which node s is as close, and the share of the contact that it takes.

    Where a node meets a vertex head-on, or is as deep under both sides of a corner, each of the two segments is as good as
    the other: the contact is then with both, in shares w_i = L_i² / (L_1² + L_2²) of their lengths along the tangent, and
    rows are means of theirs. Of the distance, which has a ridge there, that is a subgradient, and no index decides.

    Returns
    -------
    First node of the neighbour, its share (0 without a tie, 1 if segment m has no length along the tangent), its ξ and e_n.
    """
    own = max(length_along(m, e_x, e_y, position, following), 0.0)
    nearer, farther = previous[m], following[m]
    if xi > 0.5:
        nearer, farther = farther, nearer
    for other in (nearer, farther):
        g, other_xi, n_x, n_y = signed_distance(
            position[s, 0], position[s, 1], other, position, following, previous
        )
        along = max(length_along(other, n_x, n_y, position, following), 0.0)
        if abs(g - gap) <= TIE * max(own, along) and along > 0.0:
            at_vertex = (xi == 0.0 or xi == 1.0) and (other_xi == 0.0 or other_xi == 1.0)
            if at_vertex or faces(s, other, position, following, previous):
                return other, along * along / (own * own + along * along), other_xi, n_x, n_y
    return m, 0.0, xi, e_x, e_y


@device
def rows_of(
    m: int, xi: Float, gap: Float, e_x: Float, e_y: Float, keep_q: bool,
    position: Floats, following: Ints, out: Floats,
) -> None:  # fmt: skip
    """N, C_t and C_n of a node and segment m, into the first three of ``out`` (4, 3, 2)."""
    lever = length_along(m, e_x, e_y, position, following)
    normal_rows(e_x, e_y, xi, out[0])
    tangential_rows(e_x, e_y, xi, gap, lever, out[1])
    normal_rows(e_x, e_y, xi, out[2])
    if keep_q:
        end = following[m]
        t_x, t_y = position[end, 0] - position[m, 0], position[end, 1] - position[m, 1]
        turn_normal(t_x, t_y, gap, out[3], out[2])


@device
def add_forces(
    f_n: Float, f_t: Float, s: int, m: int, following: Ints, rows: Floats, force: Floats, impulse: Floats, scale: Float
) -> None:  # fmt: skip
    """f_n C_n + f_t C_t on node and segment ends; the node's, times ``scale``, on the pair's impulse."""
    end = following[m]
    for d in range(2):
        impulse[d] += scale * (f_n * rows[2, 0, d] + f_t * rows[1, 0, d])
        for row, node in enumerate((s, m, end)):
            force[node, d] += f_n * rows[2, row, d] + f_t * rows[1, row, d]


@kernel
def contact_forces(
    slots: int,
    master: Ints,
    segment: Ints,
    coordinate: Floats,
    gap: Floats,
    rest: Floats,
    normal: Floats,
    old_master: Ints,
    tangential: Floats,
    old_tangential: Floats,
    body: Ints,
    pair_of: Ints,
    pair_first: Ints,
    position: Floats,
    displacement: Floats,
    following: Ints,
    previous: Ints,
    stiffness: Floats,
    damping: Floats,
    friction: Floats,
    tangential_ratio: float,
    keep_q: bool,
    linear_to: float,
    dt: float,
    rows: Floats,
    force: Floats,
    pair_impulse: Floats,
    frictional_work: Floats,
    damping_work: Floats,
    energy: Floats,
    count: Floats,
) -> None:
    """Forces of all slave nodes in contact, added to ``force`` (n_s, 2) of slaves and segment ends.

    Every slave node has ``slots`` places; ``segment`` −1 or ``gap`` ≥ 0 is no contact. ``stiffness`` k [N/m²], ``rest`` [m],
    ``damping`` c / Δt [N/m²] and ``tangential`` [N/m] are (n_s, slots), or (0, slots) where there is no such effect. Springs
    deeper than ``linear_to`` [m] grow stiffer. ``rows`` is scratch, (2, 4, 3, 2).
    """
    energy[:] = 0.0
    count[:] = 0.0
    for s in range(len(body)):
        for j in range(slots):
            if len(tangential) > 0:
                tangential[s, j] = 0.0
            m = segment[s, j]
            if m < 0 or gap[s, j] >= 0.0:
                master[s, j] = -1
                continue
            g, xi, k = gap[s, j], coordinate[s, j], stiffness[s, j]
            e_x, e_y = normal[s, j, 0], normal[s, j, 1]
            other, share, other_xi, o_x, o_y = equally_close(
                s, m, xi, g, e_x, e_y, position, following, previous
            )
            if share == 1.0:  # at a sharp vertex whose other segment has no length along the tangent
                m, xi, share = other, other_xi, 0.0
            rows_of(m, xi, g, e_x, e_y, keep_q, position, following, rows[0])
            approach = (1.0 - share) * relative_motion(rows[0, 0], s, m, following[m], displacement)
            slip = (1.0 - share) * relative_motion(rows[0, 1], s, m, following[m], displacement)
            if share > 0.0:
                rows_of(other, other_xi, g, o_x, o_y, keep_q, position, following, rows[1])
                approach += share * relative_motion(rows[1, 0], s, other, following[other], displacement)
                slip += share * relative_motion(rows[1, 1], s, other, following[other], displacement)
            pair = pair_index(pair_of, body[s], body[m])
            depth = max(rest[s, j] - g, 0.0) if len(rest) > 0 else -g
            f_n = normal_force(k, depth, linear_to)
            energy[pair] += spring_energy(k, depth, linear_to)
            count[pair] += 1.0
            if len(damping) > 0:
                dashpot = max(-min(damping[s, j], 2.0 * k) * approach, -f_n)
                f_n += dashpot
                damping_work[pair] += max(-dashpot * approach, 0.0)
            f_t = 0.0
            if len(tangential) > 0:
                k_t = tangential_ratio * k
                stored, known = stored_force(s, body[m], old_master, old_tangential)
                if not known and approach < 0.0:
                    slip *= min(1.0, g / approach)
                f_t, lost, kept = return_to_cone(stored - k_t * slip, friction[pair] * f_n, k_t)
                frictional_work[pair] += lost
                energy[pair] += kept
                tangential[s, j] = f_t
            master[s, j] = body[m]
            scale = dt if body[s] == pair_first[pair] else -dt
            own_n, own_t = (1.0 - share) * f_n, (1.0 - share) * f_t
            add_forces(own_n, own_t, s, m, following, rows[0], force, pair_impulse[pair], scale)
            if share > 0.0:
                add_forces(
                    f_n - own_n, f_t - own_t, s, other, following, rows[1], force, pair_impulse[pair], scale
                )
