"""Gravity, constant or changing in time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.fields import FloatArray
from mpmfw.hookspecs import hookimpl
from mpmfw.kernels.nodal import add_body_force
from mpmfw.state import Grid, State

if TYPE_CHECKING:
    from mpmfw.build import Build
    from mpmfw.scene.tables import Settle


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
    ledger_term = ("gravity", "gravity")

    def __init__(self, times: FloatArray, values: FloatArray) -> None:
        self.times, self.values = times, np.ascontiguousarray(values)
        #: While a scene settles, the gravity that it settles under.
        self.override: FloatArray | None = None

    def while_settling(self, asked: Settle | None) -> None:
        """Take the gravity of the settling, if it has one, and the scene's own again after it, when ``asked`` is None."""
        gravity = None if asked is None else asked.gravity
        self.override = None if gravity is None else np.array(gravity.at(0.0))

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


def planned(made: Build) -> Gravity:
    """That of the scene; none where the scene only settles under one."""
    gravity = made.scene.gravity
    if gravity is None:
        return Gravity(np.zeros(1), np.zeros((1, made.scene.dim)))
    if gravity.is_constant:
        return Gravity(np.zeros(1), np.array([gravity.at(0.0)]))
    rows = np.array(gravity.table)
    return Gravity(rows[:, 0], rows[:, 1:])
