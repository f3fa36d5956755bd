"""Moment of contact on every body: what contact gives the grid's nodes, times their arms, summed over every
step.

Forces and momenta are compared just before the contact's hooks and just after, so that every method is
measured alike."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.kernels import kernel
from mpmfw.kernels.types import Floats, Ints
from mpmfw.plugin.hooks import Observer
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.structs import Grid, State

#: Hooks by which a contact strategy acts on momenta and on forces.
CONTACT_HOOKS = ("after_momentum_projection", "after_momentum_update", "add_nodal_force")

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
    """M_b += Σ (x_i − c_b) × (``now`` − ``before``)_i times ``scale``, ``out`` (B, 1) in 2D and (B, 3) in 3D
    [N s].

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


class ContactMoment(Observer):
    """Series of the moment on every body, about a point (dim,) [m] or, without ``about``, its centre of mass.

    It is measured from the first output on, not while a scene settles. Every body has a velocity field."""

    name = "contact_moment"
    stage = "output"
    observes = CONTACT_HOOKS
    history = ("running", "impulse")

    def __init__(self, contact: Any, about: tuple[float, ...] | None, state: State) -> None:
        self.contact, self.about, self.state = contact, about, state
        #: Since the last output [N s].
        self.impulse = np.zeros((len(state.bodies), 1 if state.grid.dim == 2 else 3))
        #: Momenta or forces of the nodes before contact.
        self._before = np.zeros((0, state.grid.dim))

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts | str:
        """Measure where every body has nodes of its own that contact acts on."""
        about, contact = setup.scene.output.contact_moment, setup.contact
        if contact is None:
            return "no contact acts"
        if not setup.field_per_body:
            return f"contact '{contact.name}' gives bodies one velocity field"
        if not any(hasattr(contact, hook) for hook in CONTACT_HOOKS):
            return f"contact '{contact.name}' neither exerts forces nor changes momenta"
        if about == "centre_of_mass":
            return Acts("about centres of mass", [cls(contact, None, setup.state)])
        return Acts(f"about {about} m", [cls(contact, about, setup.state)])

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

    def before(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:  # noqa: ARG002
        """Copy the nodes' momenta or forces before contact, (n_nodes, dim)."""
        if plugin is self.contact:
            self._before = (grid.force if hook == "add_nodal_force" else grid.momentum).copy()

    def after(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:
        """Add the moment of what contact changed."""
        if plugin is self.contact:
            forces = hook == "add_nodal_force"
            now, scale = (grid.force, dt) if forces else (grid.momentum, 1.0)
            add_moments(grid.offset, grid.position, self._centres(), self._before, now, scale, self.impulse)

    def _centres(self) -> FloatArray:
        """Return the points that the arms begin at, (B, dim) [m]."""
        if self.about is None:
            return self.state.centres_of_mass
        return np.tile(np.array(self.about), (len(self.state.bodies), 1))
