"""Reading an interpolation table."""

from __future__ import annotations

import numpy as np

from mpmfw.kernels._jit import device
from mpmfw.kernels.types import Ints


@device
def entries(row: Ints, p: int) -> range:
    """Entries of point ``p``: unsigned, so that no index of the loop is asked whether it counts from the
    end."""
    return range(np.uint64(row[p]), np.uint64(row[p + 1]))
