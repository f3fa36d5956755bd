"""Boxes that overlap, by a sweep along one axis within strips across another."""

from __future__ import annotations

from mpmfw.kernels._jit import kernel
from mpmfw.kernels.types import Floats, Ints


@kernel
def sweep_strips(
    axis: int, strip: Ints, box: Ints, lowest: Ints, lower: Floats, upper: Floats, first: Ints, second: Ints
) -> tuple[int, int]:
    """List the boxes that have a point in common, each two once.

    Entries (e,) are boxes in strips, ordered by the strip and, within it, by the box's lower end along
    ``axis``: a box is compared with those that follow until one begins beyond its end. ``lowest`` (n,) is the
    first strip of each box, so that two that meet in several strips are listed in one.

    Returns
    -------
    How many there are, stored in ``first`` and ``second`` or not, and how many comparisons that took.
    """
    dim = lower.shape[1]
    found, compared = 0, 0
    for e in range(len(box)):
        a = box[e]
        f = e + 1
        while f < len(box) and strip[f] == strip[e] and lower[box[f], axis] <= upper[a, axis]:
            b = box[f]
            f += 1
            compared += 1
            if strip[e] != max(lowest[a], lowest[b]):
                continue
            apart = False
            for d in range(dim):
                if lower[a, d] > upper[b, d] or lower[b, d] > upper[a, d]:
                    apart = True
            if not apart:
                if found < len(first):
                    first[found], second[found] = min(a, b), max(a, b)
                found += 1
    return found, compared
