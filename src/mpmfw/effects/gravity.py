"""Gravity, constant or changing in time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.kernels.nodal import add_body_force
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Grid, State
from mpmfw.state.time_table import TimeTable

if TYPE_CHECKING:
    from mpmfw.runs.build import Build
    from mpmfw.scene.tables import Settle


class Gravity:
    """f_i += m_i g(t).

    Parameters
    ----------
    table
        g (dim,) [m/s^2] in time.
    """

    name = "gravity"
    ledger_term = ("gravity", "gravity")

    def __init__(self, table: TimeTable) -> None:
        self.table = table
        #: While a scene settles, the gravity that it settles under.
        self.override: FloatArray | None = None

    def while_settling(self, asked: Settle | None) -> None:
        """Take the gravity of the settling, if it has one, and the scene's own again after it, when ``asked``
        is None.
        """
        gravity = None if asked is None else asked.gravity
        self.override = None if gravity is None else np.array(gravity.at(0.0))

    def at(self, time: float) -> FloatArray:
        """g(t), (dim,) [m/s^2]."""
        return self.table.at(time) if self.override is None else self.override

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State) -> None:
        """Body force on every velocity field."""
        add_body_force(grid.mass, self.at(state.time), grid.force, grid.spacing)


def planned(made: Build) -> Gravity:
    """That of the scene; none where the scene only settles under one."""
    gravity = made.scene.gravity
    if gravity is None:
        return Gravity(TimeTable.constant([0.0] * made.scene.dim))
    return Gravity(TimeTable.constant(gravity.at(0.0)) if gravity.table is None else TimeTable(gravity.table))
