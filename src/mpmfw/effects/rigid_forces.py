"""Forces and torques that a scene puts on free rigid bodies."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.effects.rigid import RigidBodies
from mpmfw.effects.rigid_kinematics import in_axes, matrix_of
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Grid, State
from mpmfw.units import TimeTable


class RigidForces:
    """A force F(t) through the centroid and a torque T(t) on each of the ``bodies`` (indices of rigid ones).

    The points of mass have F / (dim + 1) + A r, with Σ r × A r = T: forces that turn the body, and do not
    stretch it."""

    name = "rigid_forces"
    history = ("work",)
    ledger_term = ("external", "forces on rigid bodies")

    def __init__(self, rigid: RigidBodies, tables: dict[int, tuple[TimeTable, TimeTable]]) -> None:
        self.rigid, self.tables = rigid, tables
        self.work = 0.0  #: so far [J/m]
        #: Impulse, its moment, and the motion that the step began with, of each body.
        self.given: dict[int, tuple[FloatArray, ...]] = {}

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        rigid, dim, tables = setup.state.rigid, setup.dim, {}
        for k, body in enumerate(rigid.bodies):
            model: Any = setup.scene.bodies[body.name]
            given = [getattr(model.rigid, key, None) for key in ("force", "torque")]
            if given != [None, None]:
                lengths = dim, 1 if dim == 2 else 3
                force, torque = (
                    TimeTable.of((0.0,) * length if each is None else each)
                    for each, length in zip(given, lengths, strict=True)
                )
                tables[k] = force, torque
        names = ", ".join(rigid.bodies[k].name for k in tables)
        return Acts(names, [cls(rigid, tables)])

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State, dt: float) -> None:
        rigid, dim = self.rigid, grid.dim
        own = rigid.own(grid.force)
        for k, (forces, torques) in self.tables.items():
            force, torque = forces.mean(state.time, dt), torques.mean(state.time, dt)
            own[k] += force / (dim + 1)
            spread = (dim + 1) * rigid.radii[k] ** 2
            axes = rigid.turn[k : k + 1]
            moment = in_axes(matrix_of(torque, dim)[None], np.swapaxes(axes, 1, 2))
            own[k] += rigid.arms[k] @ in_axes(moment / (spread[:, None] + spread), axes)[0].T
            self.given[k] = dt * force, dt * torque, rigid.velocity[k].copy(), rigid.angular_velocity[k]

    @hookimpl
    def end_step(self) -> None:
        """Count the works on the mean of the motions before and after the step."""
        for k, (impulse, turn, velocity, spin) in self.given.items():
            self.work += float(0.5 * impulse @ (velocity + self.rigid.velocity[k]))
            self.work += float(0.5 * turn @ (spin + self.rigid.angular_velocity[k]))
