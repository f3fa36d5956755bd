"""Rows of the contact problem on the grid: how an impulse of a contact changes the nodes, and what it must achieve."""

from __future__ import annotations

from mpmfw.kernels import device, kernel
from mpmfw.kernels.types import Float, Floats, Indices, Ints

#: Cosine of the angle of two normals within which both belong to the same face, at the start and at the end of a step.
SAME_FACE = 0.7


@device
def better_segment(
    m: int, xi: Float, n_x: Float, n_y: Float, position: Floats, following: Ints, previous: Ints
) -> tuple[int, Float]:
    """Of the two segments that meet at a vertex (ξ = 0 or 1), the one that lies more across n."""
    other = previous[m] if xi == 0.0 else following[m]
    along = []
    for a in (m, other):
        b = following[a]
        t_x, t_y = position[b, 0] - position[a, 0], position[b, 1] - position[a, 1]
        along.append((-n_y * t_x + n_x * t_y) / (t_x * t_x + t_y * t_y) ** 0.5)
    if along[1] > along[0]:
        return other, 1.0 - xi
    return m, xi


@device
def free_gap(s: int, m: int, e: int, xi: Float, n_x: Float, n_y: Float, position: Floats) -> Float:
    """n · (x_s − (1−ξ) x_1 − ξ x_2) [m]."""
    d_x = position[s, 0] - (1.0 - xi) * position[m, 0] - xi * position[e, 0]
    d_y = position[s, 1] - (1.0 - xi) * position[m, 1] - xi * position[e, 1]
    return d_x * n_x + d_y * n_y


@device
def add_entry(
    low: int, top: int, i: int, a: Float, b: Float, grid_node: Ints, share: Floats, couple: Floats
) -> int:
    """Add to the entry of grid node i among ``low:top``, or make one; return the new top."""
    for j in range(low, top):
        if grid_node[j] == i:
            share[j] += a
            couple[j] += b
            return top
    grid_node[top], share[top], couple[top] = i, a, b
    return top + 1


@device
def add_points(
    s: int, m: int, e: int, xi: Float, turn: Float, top: int, row: Ints, nodes: Indices, weight: Floats,
    node_mass: Floats, grid_node: Ints, share: Floats, couple: Floats,
) -> tuple[int, Float]:  # fmt: skip
    """Entries of slave node s and of the ends m, e from ``top`` on; the new top, and the sum of N_i with mass, 3 if all have."""
    low, carried = top, 0.0
    for point in range(3):
        x = s if point == 0 else m if point == 1 else e
        a = 1.0 if point == 0 else xi - 1.0 if point == 1 else -xi
        b = 0.0 if point == 0 else -turn if point == 1 else turn
        for k in range(row[x], row[x + 1]):
            if weight[k] != 0.0 and node_mass[nodes[k]] > 0.0:
                carried += weight[k]
                top = add_entry(low, top, nodes[k], a * weight[k], b * weight[k], grid_node, share, couple)
    return top, carried


@kernel
def assemble(
    node: Ints,
    segment: Ints,
    coordinate: Floats,
    gap: Floats,
    normal: Floats,
    end_segment: Ints,
    end_gap: Floats,
    end_normal: Floats,
    position: Floats,
    predicted: Floats,
    following: Ints,
    previous: Ints,
    row: Ints,
    nodes: Indices,
    weight: Floats,
    node_mass: Floats,
    restore: float,
    dt: float,
    start: Ints,
    grid_node: Ints,
    share: Floats,
    couple: Floats,
    compliance_n: Floats,
    compliance_t: Floats,
    target: Floats,
) -> None:
    """Entries a_i, b_i, compliances W_n, W_t and target b of every row; rows on nodes without mass are given up.

    A unit impulse λ_n changes node i by a_i n, a unit λ_t by a_i t + b_i n, with a = (1, −(1−ξ), −ξ) and
    b = (0, −g/L, g/L) for slave node and segment ends, each spread by its N_i, L = (x_2 − x_1)·t. The couple b balances
    the moment g λ_t. W_n = Σ a_i² / m_i, W_t = Σ (a_i² + b_i²) / m_i.

    b = [g* − (1 − restore) min(g, 0)] / Δt − u_n*, u_n* being the normal relative velocity without contact and g* the gap
    that it leads to: measured at the predicted positions, or along n where a corner was passed meanwhile.
    """
    top = 0
    for r in range(len(node)):
        start[r] = top
        s, m = node[r], segment[r]
        if m < 0:
            continue
        n_x, n_y, xi, g = normal[r, 0], normal[r, 1], coordinate[r], gap[r]
        if xi == 0.0 or xi == 1.0:
            m, xi = better_segment(m, xi, n_x, n_y, position, following, previous)
            segment[r], coordinate[r] = m, xi
        e = following[m]
        lever = -n_y * (position[e, 0] - position[m, 0]) + n_x * (position[e, 1] - position[m, 1])
        top, carried = add_points(
            s, m, e, xi, g / lever, top, row, nodes, weight, node_mass, grid_node, share, couple
        )
        if abs(carried - 3.0) > 1e-9:  # part of the impulse would be lost
            segment[r] = -1
            top = start[r]
            continue
        compliance_n[r], compliance_t[r] = 0.0, 0.0
        for j in range(start[r], top):
            mass = node_mass[grid_node[j]]
            compliance_n[r] += share[j] ** 2 / mass
            compliance_t[r] += (share[j] ** 2 + couple[j] ** 2) / mass
        moved = free_gap(s, m, e, xi, n_x, n_y, predicted)
        same = end_segment[r] >= 0 and n_x * end_normal[r, 0] + n_y * end_normal[r, 1] > SAME_FACE
        end = end_gap[r] if same else moved
        target[r] = (end - (1.0 - restore) * min(g, 0.0) - (moved - g)) / dt
    start[len(node)] = top
