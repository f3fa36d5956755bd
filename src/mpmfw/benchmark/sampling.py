"""From samples to figures that a busy system does not spoil."""

from __future__ import annotations

import numpy as np

from mpmfw.state.fields import FloatArray


def stage_times(wall: FloatArray, cpu: FloatArray) -> FloatArray:
    """Time of each stage, (n_stages,): the least CPU time of a sample, shared out by the stages' least wall
    times.

    Wall time counts other processes, and the CPU timer is too slow to be read at every stage; a sum of
    stages' own least times would be that of no sample.

    Parameters
    ----------
    wall
        Wall time of every stage in every sample, (n_samples, n_stages) [s].
    cpu
        CPU time of every sample, (n_samples,) [s].
    """
    least = wall.min(axis=0)
    times: FloatArray = least * (cpu.min() / least.sum())
    return times


def quartiles(values: FloatArray) -> tuple[float, float, float]:
    """First quartile, median, third quartile."""
    low, median, high = np.quantile(values, [0.25, 0.5, 0.75])
    return float(low), float(median), float(high)
