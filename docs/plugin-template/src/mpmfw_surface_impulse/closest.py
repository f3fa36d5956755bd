"""Narrow phase: the point of the other outline that a surface node touches."""

from __future__ import annotations

import math

from mpmfw.kernels import device, kernel
from mpmfw.kernels.polyline import segment_coordinate, signed_distance, squared_distance
from mpmfw.kernels.types import Float, Floats, Indices, Ints

#: How far beyond its ends, in lengths, a segment still acts as a straight line. Without it the direction of a force on a
#: node that lies flush with a corner would be that of a distance of rounding errors.
OVERHANG = 0.05


#: Least cosine of the angle between a node's normal, reversed, and that of a segment that it may touch. A node in front of a
#: sliding block has the block's side at no distance: were the side to hold it, the block would plough.
FACING = 0.25


@device
def faces(s: int, m: int, position: Floats, following: Ints, previous: Ints) -> bool:
    """Whether the outward normal of segment m is against that of node s, the sum of its two segments' unit normals."""
    a, b, e = previous[s], following[s], following[m]
    before_x, before_y = position[s, 0] - position[a, 0], position[s, 1] - position[a, 1]
    after_x, after_y = position[b, 0] - position[s, 0], position[b, 1] - position[s, 1]
    before, after = math.hypot(before_x, before_y), math.hypot(after_x, after_y)
    # Tangents stand for normals: all turn by the same right angle.
    n_x, n_y = before_x / before + after_x / after, before_y / before + after_y / after
    m_x, m_y = position[e, 0] - position[m, 0], position[e, 1] - position[m, 1]
    lengths = math.hypot(n_x, n_y) * math.hypot(m_x, m_y)
    against: bool = n_x * m_x + n_y * m_y < -FACING * lengths
    return against


@device
def gap_to(
    s: int, m: int, position: Floats, following: Ints, previous: Ints
) -> tuple[Float, Float, Float, Float]:
    """Gap g [m] of node s to segment m, ξ, and the unit direction n out of the material (x_s = x̄ + g n)."""
    e = following[m]
    x, y = position[s, 0], position[s, 1]
    xi, gap, _, t_x, t_y = segment_coordinate(
        x, y, position[m, 0], position[m, 1], position[e, 0], position[e, 1]
    )
    if xi >= -OVERHANG and xi <= 1.0 + OVERHANG:
        return gap, xi, t_y, -t_x
    gap, xi, n_x, n_y = signed_distance(x, y, m, position, following, previous)
    return gap, xi, n_x, n_y


@kernel
def closest_points(
    node: Ints,
    first: Ints,
    candidate: Ints,
    reach: float,
    position: Floats,
    following: Ints,
    previous: Ints,
    segment: Ints,
    coordinate: Floats,
    gap: Floats,
    normal: Floats,
) -> int:
    """The closest candidate of every row whose normal is against the node's; ``segment`` is −1 where there is none.

    Where the closest of all does not face the node, the node is beside a corner. Flush with that segment, or inside, it
    belongs to the closest one round the corner that faces it, if that is not much farther; outside, it touches nothing.
    Writes ``segment`` (n_rows,), ``coordinate`` ξ, ``gap`` g [m] and ``normal`` n (n_rows, 2); returns how many were found.
    """
    found = 0
    for r in range(len(node)):
        s = node[r]
        x, y = position[s, 0], position[s, 1]
        nearest, any_square = -1, math.inf
        facing, facing_square = -1, math.inf
        for k in range(first[r], first[r + 1]):
            m = candidate[k]
            square = squared_distance(x, y, m, position, following)
            if square < any_square:
                nearest, any_square = m, square
            if square < facing_square and faces(s, m, position, following, previous):
                facing, facing_square = m, square
        segment[r] = -1
        if facing < 0 or facing_square > reach * reach:
            continue
        if facing_square > any_square:
            beside, _, _, _ = gap_to(s, nearest, position, following, previous)
            e = following[nearest]
            length = math.hypot(position[e, 0] - position[nearest, 0], position[e, 1] - position[nearest, 1])
            if beside > OVERHANG * length or facing_square > 0.25 * reach * reach:
                continue
        segment[r] = facing
        gap[r], coordinate[r], normal[r, 0], normal[r, 1] = gap_to(s, facing, position, following, previous)
        found += 1
    return found


@kernel
def predict(
    row: Ints,
    nodes: Indices,
    weight: Floats,
    node_mass: Floats,
    node_momentum: Floats,
    position: Floats,
    dt: float,
    predicted: Floats,
) -> None:
    """x_s* = x_s + Δt Σ N_i (m v)_i / m_i: where the surface would be without contact."""
    for s in range(len(position)):
        for d in range(2):
            motion = 0.0
            for k in range(row[s], row[s + 1]):
                mass = node_mass[nodes[k]]
                if mass > 0.0:
                    motion += weight[k] * node_momentum[nodes[k], d] / mass
            predicted[s, d] = position[s, d] + dt * motion
