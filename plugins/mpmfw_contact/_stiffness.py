"""Ranks of the bodies by stiffness: the stiffer of two is master."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mpmfw.api import Body, FloatArray, IntArray

#: Relative difference of the wave moduli K + 4 G / 3 up to which two bodies are equally stiff, and of sizes that are equal.
EQUAL = 1e-6


def stiffness_ranks(bodies: Sequence[Body]) -> IntArray:
    """Rank every body by its wave modulus, (body,): 0 for the softest, the same for equally stiff ones.

    The order of the bodies does not matter.
    """
    return ranks_of(np.array([body.p_wave_modulus for body in bodies]))


def ranks_of(values: FloatArray) -> IntArray:
    """Rank positive values (n,): 0 for the smallest, the same for equal ones."""
    order = np.argsort(values)
    steps = np.diff(values[order], prepend=values[order[:1]]) > EQUAL * values[order]
    ranks = np.zeros(len(values), dtype=np.int64)
    ranks[order] = np.cumsum(steps)
    return ranks
