"""Values in time: linear between the rows of a table, constant outside."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mpmfw.fields import FloatArray


class TimeTable:
    """Rows (t, values …) as one function of time; a single row is a constant.

    Parameters
    ----------
    rows
        (m, 1 + n), with times [s] that increase.
    """

    def __init__(self, rows: Sequence[Sequence[float]]) -> None:
        table = np.array(rows, dtype=float)
        self.times, self.values = table[:, 0], np.ascontiguousarray(table[:, 1:])

    @classmethod
    def constant(cls, values: Sequence[float]) -> TimeTable:
        """The same values (n,) at all times."""
        return cls([(0.0, *values)])

    def at(self, time: float) -> FloatArray:
        """Values (n,) at a ``time`` [s]."""
        if len(self.times) == 1:
            return np.asarray(self.values[0])
        return np.array([np.interp(time, self.times, column) for column in self.values.T])
