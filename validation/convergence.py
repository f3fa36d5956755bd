"""Orders of convergence that several cases observe."""

import numpy as np


def observed_order(sizes: np.ndarray, errors: np.ndarray) -> float:
    """Slope of the least-squares line of log |error| over log(cell size)."""
    return float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])
