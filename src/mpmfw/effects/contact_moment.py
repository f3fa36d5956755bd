"""Moment of contact on every body: what contact gives the grid's nodes, times their arms, summed over every step.

Nothing is asked of the contact but where it acts: forces and momenta are looked at just before its hooks and just after, so that
every method is measured alike.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.kernels import kernel
from mpmfw.kernels.types import Floats, Ints
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.state.fields import AnyArray, Field, FloatArray, IntArray
from mpmfw.state.structs import Grid, State

#: Hooks by which a contact strategy acts on momenta and on forces.
IMPULSES, FORCES = ("after_momentum_projection", "after_momentum_update"), ("add_nodal_force",)

CONTACT_MOMENT = Field(
    "contact_moment",
    ("body", "rotation"),
    "N m m-1",
    "moment of contact on the body, mean over the output interval",
    "series",
    output=True,
    mean=True,
)


@kernel
def add_moments(
    first: Ints, position: Floats, centre: Floats, before: Floats, now: Floats, scale: float, out: Floats
) -> None:
    """M_b += Σ (x_i − c_b) × (``now`` − ``before``)_i times ``scale``, ``out`` (B, 1) in 2D and (B, 3) in 3D [N s].

    Nodes ``first[b]:first[b + 1]`` belong to body b; ``centre`` is (B, dim) [m].
    """
    dim = position.shape[1]
    for b in range(len(first) - 1):
        for i in range(first[b], first[b + 1]):
            for a in range(out.shape[1]):
                d, e = (0, 1) if dim == 2 else ((a + 1) % 3, (a + 2) % 3)
                along = (position[i, d] - centre[b, d]) * (now[i, e] - before[i, e])
                across = (position[i, e] - centre[b, e]) * (now[i, d] - before[i, d])
                out[b, a] += scale * (along - across)


class ContactMoment:
    """The moment on every body as a series, about its centre of mass or about one point.

    It is looked at from the first output on: while a scene settles, nothing is added.

    Parameters
    ----------
    about
        The point (dim,) [m], or None for every body's centre of mass at the beginning of each step.
    state
        Whose bodies have a velocity field each.
    """

    name = "contact_moment"
    stage = "output"
    history = ("running", "impulse")

    def __init__(self, about: tuple[float, ...] | None, state: State) -> None:
        self.about, self.state, self.running = about, state, False
        self.first: IntArray = np.array([body.particles.start for body in state.bodies])
        self.impulse = np.zeros(
            (len(state.bodies), 1 if state.grid.dim == 2 else 3)
        )  #: since the last output [N s]
        self.before = np.zeros((0, state.grid.dim))  #: momenta or forces of the nodes at the last look

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The moment."""
        return [CONTACT_MOMENT]

    @hookimpl
    def diagnostics(self, interval: float) -> dict[str, AnyArray]:
        """Mean over the ``interval`` [s] since the last output; zero at the first."""
        moment = self.impulse / interval if interval > 0.0 else np.zeros_like(self.impulse)
        self.running = True
        self.impulse = np.zeros_like(self.impulse)
        return {"contact_moment": moment}

    def look(self, nodal: FloatArray) -> None:
        """Before contact: the nodes' momenta or forces, (n_nodes, dim)."""
        self.before = nodal.copy()

    def add(self, grid: Grid, nodal: FloatArray, scale: float) -> None:
        """After it; ``scale`` is the time that the change acts [s], or 1 of momenta."""
        add_moments(grid.offset, grid.position, self._centres(), self.before, nodal, scale, self.impulse)

    def _centres(self) -> FloatArray:
        """What the arms begin at, (B, dim) [m]."""
        if self.about is not None:
            return np.tile(np.array(self.about), (len(self.first), 1))
        p = self.state.particles
        weighted = np.add.reduceat(p.mass[:, None] * p.position, self.first)
        return np.asarray(weighted / np.add.reduceat(p.mass, self.first)[:, None])


class BeforeForces:
    """Just before contact adds its forces."""

    name = "contact_moment_before_forces"
    stage = "output"

    def __init__(self, moment: ContactMoment) -> None:
        self.moment = self.only_while = moment

    @hookimpl
    def add_nodal_force(self, grid: Grid) -> None:
        """Forces without those of contact."""
        self.moment.look(grid.force)


class AfterForces:
    """Just after that."""

    name = "contact_moment_after_forces"
    stage = "output"

    def __init__(self, moment: ContactMoment) -> None:
        self.moment = self.only_while = moment

    @hookimpl
    def add_nodal_force(self, grid: Grid, dt: float) -> None:
        """What came is contact's, for the step of ``dt`` [s]."""
        self.moment.add(grid, grid.force, dt)


class BeforeImpulses:
    """Just before contact corrects momenta."""

    name = "contact_moment_before_impulses"
    stage = "output"

    def __init__(self, moment: ContactMoment) -> None:
        self.moment = self.only_while = moment

    @hookimpl
    def after_momentum_projection(self, grid: Grid) -> None:
        """Momenta as they were projected."""
        self.moment.look(grid.momentum)

    @hookimpl
    def after_momentum_update(self, grid: Grid) -> None:
        """Momenta as they were integrated."""
        self.moment.look(grid.momentum)


class AfterImpulses:
    """Just after that."""

    name = "contact_moment_after_impulses"
    stage = "output"

    def __init__(self, moment: ContactMoment) -> None:
        self.moment = self.only_while = moment

    @hookimpl
    def after_momentum_projection(self, grid: Grid) -> None:
        """What changed is contact's."""
        self.moment.add(grid, grid.momentum, 1.0)

    @hookimpl
    def after_momentum_update(self, grid: Grid) -> None:
        """As before."""
        self.moment.add(grid, grid.momentum, 1.0)


def around(contact: Any, moment: ContactMoment) -> list[Any]:
    """The contact between those that look before and after the hooks that it has, and the moment itself."""
    before: list[Any] = []
    after: list[Any] = []
    if any(hasattr(contact, hook) for hook in FORCES):
        before, after = [BeforeForces(moment)], [AfterForces(moment)]
    if any(hasattr(contact, hook) for hook in IMPULSES):
        before, after = [*before, BeforeImpulses(moment)], [*after, AfterImpulses(moment)]
    return [*before, contact, *after, moment]
