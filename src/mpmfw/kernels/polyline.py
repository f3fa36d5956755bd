"""Geometry of two-node segments and closed polylines in the plane.

Orientation: the material lies on the left of the direction of travel, so that the outward unit normal of a
segment with unit tangent e_t is e_n = (e_t,y, −e_t,x).
"""

from __future__ import annotations

import math

from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.types import Float, Floats, Ints


@device
def segment_coordinate(
    x: Float, y: Float, x1: Float, y1: Float, x2: Float, y2: Float
) -> tuple[Float, Float, Float, Float, Float]:
    """Project a point on the line through a segment (eq. 3, 4 of [H17]).

    Returns
    -------
    ξ (not limited to 0 … 1), normal gap g_n [m], length l [m], and the unit tangent e_t.
    """
    tx, ty = x2 - x1, y2 - y1
    length = math.sqrt(tx * tx + ty * ty)
    tx, ty = tx / length, ty / length
    xi = ((x - x1) * tx + (y - y1) * ty) / length
    gap = (x - x1) * ty - (y - y1) * tx
    return xi, gap, length, tx, ty


@device
def signed_distance(
    x: Float, y: Float, a: int, position: Floats, following: Ints, previous: Ints
) -> tuple[Float, Float, Float, Float]:
    """Distance of a point from segment ``a`` of a closed polyline, negative inside the material.

    Where the closest point is an end of the segment, the pseudo-normal there (sum of both segments' normals)
    decides inside or outside, and nothing else; the direction is that of x − x_end, along which an action and
    its reaction leave no moment.

    Returns
    -------
    Signed distance g [m], ξ limited to 0 … 1, and the unit direction e_n: x = x_closest + g e_n.
    """
    b = following[a]
    xi, gap, _, tx, ty = segment_coordinate(
        x, y, position[a, 0], position[a, 1], position[b, 0], position[b, 1]
    )
    nx, ny = ty, -tx
    if xi > 0.0 and xi < 1.0:
        return gap, xi, nx, ny
    # The end, and the other segment that meets there.
    xi = 0.0 if xi <= 0.0 else 1.0
    end = a if xi == 0.0 else b
    start = previous[a] if xi == 0.0 else b
    stop = following[start]
    ux, uy = position[stop, 0] - position[start, 0], position[stop, 1] - position[start, 1]
    length = math.sqrt(ux * ux + uy * uy)
    px, py = nx + uy / length, ny - ux / length
    dx, dy = x - position[end, 0], y - position[end, 1]
    distance = math.sqrt(dx * dx + dy * dy)
    if distance < 1e-14 * length:
        norm = math.sqrt(px * px + py * py)
        return 0.0, xi, px / norm, py / norm
    if dx * px + dy * py < 0.0:
        return -distance, xi, -dx / distance, -dy / distance
    return distance, xi, dx / distance, dy / distance


@device
def squared_distance(x: Float, y: Float, a: int, position: Floats, following: Ints) -> Float:
    """Squared distance of a point from segment ``a`` [m²]."""
    b = following[a]
    tx, ty = position[b, 0] - position[a, 0], position[b, 1] - position[a, 1]
    dx, dy = x - position[a, 0], y - position[a, 1]
    xi = min(max((dx * tx + dy * ty) / (tx * tx + ty * ty), 0.0), 1.0)
    return (dx - xi * tx) ** 2 + (dy - xi * ty) ** 2


@kernel
def minimum_gap(
    first_a: int, last_a: int, first_b: int, last_b: int, position: Floats, following: Ints, previous: Ints
) -> float:
    """Least signed distance of nodes ``first_a:last_a`` from the segments ``first_b:last_b`` [m].

    Each node counts with its closest segment; the least over the nodes is negative as soon as one is inside.
    """
    x0, x1, y0, y1 = math.inf, -math.inf, math.inf, -math.inf
    for m in range(first_b, last_b):
        x0, x1 = min(x0, position[m, 0]), max(x1, position[m, 0])
        y0, y1 = min(y0, position[m, 1]), max(y1, position[m, 1])
    least = math.inf
    for s in range(first_a, last_a):
        x, y = position[s, 0], position[s, 1]
        dx, dy = max(x0 - x, x - x1, 0.0), max(y0 - y, y - y1, 0.0)
        if least > 0.0 and dx * dx + dy * dy > least * least:
            continue  # outside the other body's box by more than the least distance found
        nearest, closest = math.inf, first_b
        for m in range(first_b, last_b):
            square = squared_distance(x, y, m, position, following)
            if square < nearest:
                nearest, closest = square, m
        gap, _, _, _ = signed_distance(x, y, closest, position, following, previous)
        least = min(least, gap)
    return least


@kernel
def bounding_boxes(first: Ints, position: Floats, lower: Floats, upper: Floats) -> None:
    """Bounding box of the nodes ``first[b]:first[b + 1]`` of every body b; an empty range gives an empty
    box."""
    for b in range(len(first) - 1):
        for d in range(2):
            low, high = math.inf, -math.inf
            for s in range(first[b], first[b + 1]):
                low = min(low, position[s, d])
                high = max(high, position[s, d])
            lower[b, d], upper[b, d] = low, high
