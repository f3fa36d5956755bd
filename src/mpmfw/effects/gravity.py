"""Gravity, constant or changing in time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.kernels.particle_grid import add_body_force
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Grid, State
from mpmfw.units import TimeTable

if TYPE_CHECKING:
    from mpmfw.scene.tables import Settle


class Gravity:
    """f_i += m_i g(t), with a table of g (dim,) [m/s^2] in time."""

    name = "gravity"
    ledger_term = ("gravity", "gravity")

    def __init__(self, table: TimeTable) -> None:
        self.table = table
        self.while_settling(None)

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Return the scene's gravity; none if the scene only settles under one."""
        gravity = setup.scene.gravity
        if gravity is None:
            still = TimeTable.constant([0.0] * setup.dim)
            return Acts("[settle.gravity], while settling", [cls(still)])
        table = TimeTable.constant(gravity.at(0.0)) if gravity.table is None else TimeTable(gravity.table)
        return Acts("[gravity]", [cls(table)])

    def while_settling(self, asked: Settle | None) -> None:
        """Take the settling's gravity, or the scene's at time zero; the scene's when ``asked`` is None."""
        constant = self.table.at(0.0) if asked is not None or len(self.table.times) == 1 else None
        gravity = None if asked is None else asked.gravity
        self.constant: FloatArray | None = constant if gravity is None else np.array(gravity.at(0.0))

    def at(self, time: float) -> FloatArray:
        """g(t), (dim,) [m/s^2]."""
        return self.table.at(time) if self.constant is None else self.constant

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State, dt: float) -> None:
        mean = self.table.mean(state.time, dt) if self.constant is None else self.constant
        add_body_force(grid.mass, mean, grid.force, grid.spacing)
