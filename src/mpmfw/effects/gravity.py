"""Gravity, constant or changing in time."""

from __future__ import annotations

import numpy as np

from mpmfw.fields import FloatArray
from mpmfw.hookspecs import hookimpl
from mpmfw.kernels.nodal import add_body_force
from mpmfw.state import Grid, State


class Gravity:
    """f_i += m_i g(t); g is linear between the rows of a table and constant outside.

    Parameters
    ----------
    times
        (m,) [s], increasing.
    values
        (m, dim) [m/s^2].
    """

    name = "gravity"

    def __init__(self, times: FloatArray, values: FloatArray) -> None:
        self.times, self.values = times, np.ascontiguousarray(values)
        #: While a scene settles, the gravity that it settles under; recorded motion starts when this is None
        #: again.
        self.override: FloatArray | None = None

    def at(self, time: float) -> FloatArray:
        """g(t), (dim,) [m/s^2]."""
        if self.override is not None:
            return self.override
        if len(self.times) == 1:
            return np.asarray(self.values[0])
        return np.array([np.interp(time, self.times, column) for column in self.values.T])

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State) -> None:
        """Body force on every velocity field."""
        add_body_force(grid.mass, self.at(state.time), grid.force, grid.spacing)
