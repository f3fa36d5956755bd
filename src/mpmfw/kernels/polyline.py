"""Geometry of two-node segments and closed polylines in the plane.

Orientation: the material lies on the left of the direction of travel, so that the outward unit normal of a
segment with unit tangent e_t is e_n = (e_t,y, −e_t,x).
"""

from __future__ import annotations

import math

import numpy as np

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


#: Consecutive segments that share a bounding box where the closest one is looked for.
BLOCK = 8


@device
def block_boxes(first: int, last: int, position: Floats, following: Ints, boxes: Floats) -> None:
    """Bounding boxes x0, x1, y0, y1 of each ``BLOCK`` of the segments ``first:last``, into the rows of ``boxes``."""
    for m in range(first, last):
        row, e = (m - first) // BLOCK, following[m]
        if (m - first) % BLOCK == 0:
            boxes[row, 0], boxes[row, 1], boxes[row, 2], boxes[row, 3] = (
                math.inf,
                -math.inf,
                math.inf,
                -math.inf,
            )
        boxes[row, 0] = min(boxes[row, 0], position[m, 0], position[e, 0])
        boxes[row, 1] = max(boxes[row, 1], position[m, 0], position[e, 0])
        boxes[row, 2] = min(boxes[row, 2], position[m, 1], position[e, 1])
        boxes[row, 3] = max(boxes[row, 3], position[m, 1], position[e, 1])


@device
def box_distance(x: Float, y: Float, x0: Float, x1: Float, y0: Float, y1: Float) -> Float:
    """Squared distance of a point from the box ``x0`` … ``x1``, ``y0`` … ``y1`` [m²], 0 inside."""
    dx, dy = max(x0 - x, x - x1, 0.0), max(y0 - y, y - y1, 0.0)
    return dx * dx + dy * dy


@device
def closest_segment(
    x: Float, y: Float, within: Float, guess: int, first: int, last: int, position: Floats, following: Ints, boxes: Floats
) -> int:  # fmt: skip
    """Of the segments ``first:last`` that closest to a point, of equally close ones the first; −1 if none is near.

    ``boxes`` are those of the segments' blocks (:func:`block_boxes`), ``within`` is the square of the distance from which on
    they are of no interest [m²]. Only blocks are looked through whose box is not farther than that, or than what was found;
    the block of ``guess`` is the first.
    """
    nearest, closest = within, -1
    blocks = (last - first + BLOCK - 1) // BLOCK
    for visit in range(-1, blocks):
        block = (guess - first) // BLOCK if visit < 0 else visit
        box = box_distance(x, y, boxes[block, 0], boxes[block, 1], boxes[block, 2], boxes[block, 3])
        # The allowances are beyond rounding: no segment is passed over that the arithmetic would find closer.
        if box > nearest * (1.0 + 1e-9) + 1e-24 * (x * x + y * y):
            continue
        for m in range(first + block * BLOCK, min(first + (block + 1) * BLOCK, last)):
            square = squared_distance(x, y, m, position, following)
            if square < nearest or (square == nearest and (closest < 0 or m < closest)):
                nearest, closest = square, m
    return closest


@device
def least_gap(
    first_a: int, last_a: int, first_b: int, last_b: int, least: Float,
    position: Floats, following: Ints, previous: Ints, boxes: Floats,
) -> Float:  # fmt: skip
    """``least``, or the least signed distance of nodes ``first_a:last_a`` from the segments ``first_b:last_b`` [m] if less.

    ``boxes`` are those of the segments' blocks. The node that is closest to the box round them all goes first: most others
    turn out to be farther from that box than the distance then found.
    """
    x0, x1, y0, y1 = math.inf, -math.inf, math.inf, -math.inf
    for block in range((last_b - first_b + BLOCK - 1) // BLOCK):
        x0, x1 = min(x0, boxes[block, 0]), max(x1, boxes[block, 1])
        y0, y1 = min(y0, boxes[block, 2]), max(y1, boxes[block, 3])
    start, shortest = first_a, math.inf
    for s in range(first_a, last_a):
        box = box_distance(position[s, 0], position[s, 1], x0, x1, y0, y1)
        if box < shortest:
            start, shortest = s, box
    closest = first_b
    for visit in range(first_a - 1, last_a):
        s = start if visit < first_a else visit
        x, y = position[s, 0], position[s, 1]
        box = box_distance(x, y, x0, x1, y0, y1)
        square = max(least, 0.0) * max(least, 0.0)
        if box > square:
            continue  # farther from the whole outline's box than the least distance, or outside where another is inside
        # What is within the box may be inside, and deeper than the least distance found.
        within = square * (1.0 + 1e-9) if box > 0.0 else math.inf
        m = closest_segment(x, y, within, closest, first_b, last_b, position, following, boxes)
        if m >= 0:
            closest = m
            gap, _, _, _ = signed_distance(x, y, m, position, following, previous)
            least = min(least, gap)
    return least


@kernel
def minimum_gap(
    first_a: int, last_a: int, first_b: int, last_b: int, position: Floats, following: Ints, previous: Ints
) -> float:
    """Least signed distance of nodes ``first_a:last_a`` from the segments ``first_b:last_b`` [m].

    Each node counts with its closest segment; the least over the nodes is negative as soon as one is inside.
    """
    boxes = np.empty(((last_b - first_b) // BLOCK + 1, 4))
    block_boxes(first_b, last_b, position, following, boxes)
    least: float = least_gap(first_a, last_a, first_b, last_b, math.inf, position, following, previous, boxes)
    return least


@kernel
def minimum_gaps(
    first: Ints,
    second: Ints,
    body_first: Ints,
    position: Floats,
    following: Ints,
    previous: Ints,
    gaps: Floats,
) -> None:
    """Least distance of the outlines of every two bodies ``first`` and ``second``, into ``gaps`` [m].

    The lesser of both ways of :func:`minimum_gap`, of the nodes of one from the segments of the other; the nodes of body b
    are ``body_first[b]:body_first[b + 1]``.
    """
    n_bodies = len(body_first) - 1
    boxes = np.empty((body_first[n_bodies] // BLOCK + n_bodies, 4))
    for b in range(n_bodies):
        start = body_first[b] // BLOCK + b
        block_boxes(body_first[b], body_first[b + 1], position, following, boxes[start:])
    for c in range(len(first)):
        least = math.inf
        for way in range(2):
            a, b = (first[c], second[c]) if way == 0 else (second[c], first[c])
            least = least_gap(
                body_first[a], body_first[a + 1], body_first[b], body_first[b + 1], least,
                position, following, previous, boxes[body_first[b] // BLOCK + b :],
            )  # fmt: skip
        gaps[c] = least


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
