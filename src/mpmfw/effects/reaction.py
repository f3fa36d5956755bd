"""Reaction of rigid bodies: force, moment and work of contact on each, as series."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.effects.contact_moment import CONTACT_HOOKS
from mpmfw.effects.rigid import RigidBodies
from mpmfw.effects.rigid_kinematics import vector_of
from mpmfw.plugin.hooks import Observer
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Grid


def _series(name: str, dims: tuple[str, ...], unit: str, meaning: str, *, mean: bool = True) -> Field:
    return Field(name, ("body", *dims), unit, meaning, "series", output=True, missing=True, mean=mean)


FIELDS = (
    _series(
        "reaction", ("axis",), "N m-1", "force of contact on the rigid body, mean over the output interval"
    ),
    _series(
        "reaction_moment", ("rotation",), "N m m-1", "its moment about the body's reference point, likewise"
    ),
    _series("reaction_work", (), "J m-1", "work of contact on the rigid body since time zero", mean=False),
)

#: Normal force along a belt, over the whole normal force, from which a run warns.
ALONG = 0.1


class Reaction(Observer):
    """Force, moment and work of contact on rigid bodies, observed at the hooks of contact.

    ``work`` is what has been put in to keep the prescribed motions [J/m]."""

    name = "reaction"
    stage = "output"
    observes = CONTACT_HOOKS
    history = ("running", "impulse", "moment", "works", "work")
    ledger_term = ("external", "rigid bodies")

    def __init__(self, contact: Any, rigid: RigidBodies) -> None:
        self.contact, self.rigid, count = contact, rigid, len(rigid.bodies)
        self.impulse = np.zeros((count, rigid.dim))  #: since the last output [N s/m]
        self.moment = np.zeros((count, rigid.dim, rigid.dim))
        self.works = np.zeros(count)  #: since time zero [J/m]
        self.work = 0.0
        #: Impulse and moment of the step, and the motion that it began with.
        self.of_step = np.zeros_like(self.impulse), np.zeros_like(self.moment)
        self.begin = rigid.velocity + rigid.belt, rigid.spin.copy()
        self._before: FloatArray = np.zeros(0)

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        return Acts("force, moment and work", [cls(setup.contact, setup.state.rigid)])

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return list(FIELDS)

    def before(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:  # noqa: ARG002
        if plugin is self.contact:
            self._before = self.rigid.own(grid.force if hook == "add_nodal_force" else grid.momentum).copy()

    def after(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:
        if plugin is not self.contact:
            return
        forces, rigid = hook == "add_nodal_force", self.rigid
        change = rigid.own(grid.force if forces else grid.momentum) - self._before
        if not change.any():
            return
        lever = np.einsum("njd,nje->nde", change, rigid.arms)
        scale = dt if forces else 1.0
        impulse, moment = scale * change.sum(axis=1), scale * (lever - np.swapaxes(lever, 1, 2))
        self.impulse += impulse
        self.moment += moment
        self.of_step[0][...] += impulse
        self.of_step[1][...] += moment
        self.begin = rigid.velocity + rigid.belt, rigid.spin.copy()
        work = _work(impulse, moment, *self.begin)
        self.works += work
        self.work -= float(work[rigid.prescribed].sum())

    @hookimpl
    def end_step(self) -> None:
        """Count the works on the mean of the motions before and after the step."""
        before, now = self.begin, (self.rigid.velocity, self.rigid.spin)
        gained = 0.5 * _work(*self.of_step, *(b - a for a, b in zip(before, now, strict=True)))
        self.works += np.where(self.rigid.prescribed, 0.0, gained)
        for array in self.of_step:
            array.fill(0.0)

    @hookimpl
    def diagnostics(self, interval: float) -> dict[str, AnyArray]:
        """Return means over the ``interval`` [s] since the last output, zero at the first, and the works."""
        scale = 1.0 / interval if interval > 0.0 else 0.0
        series = {"reaction": scale * self.impulse, "reaction_moment": scale * vector_of(self.moment)}
        self.running = True
        self.impulse, self.moment = np.zeros_like(self.impulse), np.zeros_like(self.moment)
        soft = len(self.rigid.state.soft_bodies)
        found = {**series, "reaction_work": self.works.copy()}
        return {
            name: np.concatenate([np.full((soft, *values.shape[1:]), np.nan), values])
            for name, values in found.items()
        }

    @hookimpl
    def concerns(self) -> list[str]:
        """Return belts against whose velocity contact pushes: each law makes another motion of that."""
        rigid, arrays, warnings = self.rigid, self.rigid.state.arrays, list[str]()
        whole, tangential = (f"{self.contact.name}/{name}" for name in ("impulse", "friction_impulse"))
        if whole not in arrays or tangential not in arrays:
            return warnings
        pushes, bodies = arrays[whole] - arrays[tangential], rigid.state.pair_bodies
        for body, (*_, belt) in zip(rigid.bodies, rigid.motion, strict=True):
            push = pushes[(bodies == body.index).any(axis=1)]
            along = np.abs(push @ belt.values.T)
            size = np.linalg.norm(push, axis=1)[:, None] * np.linalg.norm(belt.values, axis=1)
            if (along > ALONG * size).any():
                warnings.append(
                    f"{body.name}: contact pushes along its surface_velocity, and what comes of that differs "
                    "from law to law; expected a belt along the faces that touch"
                )
        return warnings


def _work(impulse: FloatArray, moment: FloatArray, velocity: FloatArray, spin: FloatArray) -> FloatArray:
    """Return I·v + M·ω of every body (n,), with M and ω as matrices."""
    return np.asarray(np.einsum("nd,nd->n", impulse, velocity) + 0.5 * np.einsum("nde,nde->n", moment, spin))
