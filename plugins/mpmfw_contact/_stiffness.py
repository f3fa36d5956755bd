"""Ranks of the bodies by stiffness: the stiffer of two is master."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mpmfw.api import Body, IntArray

#: Relative difference of the wave moduli K + 4 G / 3 up to which two bodies are equally stiff.
EQUAL = 1e-6


def stiffness_ranks(bodies: Sequence[Body]) -> IntArray:
    """Rank every body by its wave modulus, (body,): 0 for the softest, the same for equally stiff ones.

    The order of the bodies does not matter.
    """
    modulus = np.array([body.p_wave_modulus for body in bodies])
    order = np.argsort(modulus)
    steps = np.diff(modulus[order], prepend=modulus[order[:1]]) > EQUAL * modulus[order]
    ranks = np.zeros(len(bodies), dtype=np.int64)
    ranks[order] = np.cumsum(steps)
    return ranks
