"""Points of two bodies that are near each other, from buckets of cells."""

from __future__ import annotations

import math

from mpmfw.kernels import device, kernel
from mpmfw.kernels.boxes import Boxes, boxes_apart
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.types import Float, Floats, Ints, Points

#: Reach over the sum of the radii up to which two points have a row, a step before they touch.
NEAR = 1.25


@device
def radius(volume: Float, dim: int) -> Float:
    """Half the edge of a cube of this volume: spheres in a lattice touch."""
    return 0.5 * (math.sqrt(volume) if dim == 2 else volume ** (1.0 / 3.0))


@device
def bucket_of(p: int, position: Floats, size: Float, moved_by: int, buckets: int) -> int:
    """Bucket of point p's cell of edge ``size``, or of a neighbour: digits of ``moved_by`` to the base 3."""
    key, rest = 0, moved_by
    for d in range(position.shape[1]):
        cell = math.floor(position[p, d] / size) + (rest % 3 - 1 if moved_by >= 0 else 0)
        key = (key * 73856093) ^ (cell * 19349663)
        rest //= 3
    return key & (buckets - 1)


@device
def may_meet(p: int, position: Floats, body: int, boxes: Boxes, reach: Float) -> bool:
    """Return True if point p lies within ``reach`` of a body's box."""
    for d in range(position.shape[1]):
        x = position[p, d]
        if x < boxes.lower[body, d] - reach or x > boxes.upper[body, d] + reach:
            return False
    return True


@kernel
def find_near(
    pairs: Ints, first: Ints, points: Points, reach: float, boxes: Boxes, head: Ints, after: Ints, rows: Rows
) -> int:
    """Write pair and identity of the points that are near each other, by ``pairs`` (pair, 2), then first and
    second point; return how many there are, stored or not.

    ``first`` (n_bodies + 1,) are the bodies' first points, ``reach`` the largest distance of near ones [m].
    ``head`` (2^k,) is the first point of a bucket, −1 before and after, ``after`` (n_p,) the next one.
    """
    count, position = 0, points.position
    for pair in range(len(pairs)):
        a, b = pairs[pair, 0], pairs[pair, 1]
        if boxes_apart(a, b, boxes.lower, boxes.upper, reach):
            continue
        for q in range(first[b], first[b + 1]):
            if may_meet(q, position, a, boxes, reach):
                k = bucket_of(q, position, reach, -1, len(head))
                after[q], head[k] = head[k], q
        for p in range(first[a], first[a + 1]):
            if may_meet(p, position, b, boxes, reach):
                count = list_neighbours(p, pair, reach, points, head, after, rows, count)
        for q in range(first[b], first[b + 1]):
            if may_meet(q, position, a, boxes, reach):
                head[bucket_of(q, position, reach, -1, len(head))] = -1
    return count


@device
def list_neighbours(
    p: int, pair: int, reach: Float, points: Points, head: Ints, after: Ints, rows: Rows, count: int
) -> int:
    """Add the points near point p from the buckets round it, in their order; return how many are listed."""
    position, volume, begin = points.position, points.volume, count
    n, dim = position.shape
    for near in range(3**dim):
        k = bucket_of(p, position, reach, near, len(head))
        seen = False  # two cells may fall in one bucket
        for before in range(near):
            seen = seen or bucket_of(p, position, reach, before, len(head)) == k
        q = -1 if seen else head[k]
        while q >= 0:
            square = 0.0
            for d in range(dim):
                square += (position[p, d] - position[q, d]) ** 2
            most = NEAR * (radius(volume[p], dim) + radius(volume[q], dim))
            if 0.0 < square < most * most:
                i, identity = count, (pair * n + p) * n + q
                if count < len(rows.pair):
                    while i > begin and rows.identity[i - 1] > identity:
                        rows.identity[i] = rows.identity[i - 1]
                        i -= 1
                    rows.pair[count], rows.identity[i] = pair, identity
                count += 1
            q = after[q]
    return count
