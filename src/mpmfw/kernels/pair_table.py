"""From two bodies to the index of their pair, without an array of bodies by bodies."""

from __future__ import annotations

import numpy as np

from mpmfw.kernels._jit import device
from mpmfw.kernels.types import Ints


def pair_table(first: Ints, second: Ints) -> Ints:
    """Table that :func:`pair_index` reads: (n_pairs, 2), a key of the two bodies that ascends, and the pair's
    index.

    Parameters
    ----------
    first, second
        Indices of both bodies of every pair, (n_pairs,).
    """
    key = (np.minimum(first, second) << 32) | np.maximum(first, second)
    order = np.argsort(key)
    return np.ascontiguousarray(np.stack([key[order], order], axis=1))


@device
def pair_index(pair_of: Ints, a: int, b: int) -> int:
    """Index of the pair of bodies a and b, in either order; −1 for none. Bisection of the table's keys."""
    key = (min(a, b) << 32) | max(a, b)
    low, high = 0, len(pair_of)
    while low < high:
        middle = (low + high) // 2
        if pair_of[middle, 0] < key:
            low = middle + 1
        else:
            high = middle
    if low < len(pair_of) and pair_of[low, 0] == key:
        index: int = pair_of[low, 1]
        return index
    return -1
