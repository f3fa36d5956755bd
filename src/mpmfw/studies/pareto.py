"""The front of combinations of which no other is better in one respect and at least as good in the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mpmfw.state.fields import FloatArray


def front(error: FloatArray, cost: FloatArray) -> NDArray[np.bool_]:
    """Mark what is not dominated.

    Parameters
    ----------
    error, cost
        Arrays of one shape, smaller is better. NaN: not known, never on the front.

    Returns
    -------
    ndarray of bool
        Same shape. One is dominated where another has no larger error and no larger cost, and one of them smaller;
        of two that are the same both are on the front or none.
    """
    pairs = np.stack([np.ravel(cost), np.ravel(error)], axis=1)
    known = np.isfinite(pairs).all(axis=1)
    different, place = np.unique(pairs[known], axis=0, return_inverse=True)  # by rising cost, then error
    cheaper = np.minimum.accumulate(np.append(np.inf, different[:-1, 1]))  # least error of those before
    on = np.zeros(known.shape, dtype=bool)
    on[known] = (different[:, 1] < cheaper)[np.ravel(place)]
    return on.reshape(np.shape(error))
