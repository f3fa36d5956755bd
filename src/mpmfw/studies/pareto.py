"""The front of combinations of which no other is better in one respect and at least as good in the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mpmfw.fields import FloatArray


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
    flat_error, flat_cost = np.ravel(error), np.ravel(cost)
    on = np.zeros(flat_error.shape, dtype=bool)
    known = np.flatnonzero(np.isfinite(flat_error) & np.isfinite(flat_cost))
    order = known[np.lexsort((flat_error[known], flat_cost[known]))]
    last = (np.inf, np.inf)  # by rising cost, the front is where the error falls
    for k in order:
        here = (float(flat_error[k]), float(flat_cost[k]))
        on[k] = here[0] < last[0] or here == last
        last = here if on[k] else last
    return on.reshape(np.shape(error))
