"""Moment of contact on every body: the change of forces and momenta by the contact's hooks, times the arms
of the nodes, summed over every step."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.effects.series import cross
from mpmfw.plugin.hooks import Observer
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Setup
from mpmfw.state.fields import AnyArray, Field
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
        """Measure if every body has separate nodes on which contact acts."""
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
        return [CONTACT_MOMENT]

    @hookimpl
    def diagnostics(self, interval: float) -> dict[str, AnyArray]:
        """Mean over the ``interval`` [s] since the last output; zero at the first."""
        moment = self.impulse / interval if interval > 0.0 else np.zeros_like(self.impulse)
        self.running = True
        self.impulse = np.zeros_like(self.impulse)
        return {"contact_moment": moment}

    def before(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:  # noqa: ARG002
        if plugin is self.contact:
            self._before = (grid.force if hook == "add_nodal_force" else grid.momentum).copy()

    def after(self, hook: str, plugin: Any, grid: Grid, dt: float) -> None:
        """Add M_b = Σ (x_i − c_b) × I_i, I_i the impulse of contact [N s]."""
        if plugin is not self.contact:
            return
        forces, bodies = hook == "add_nodal_force", len(self.impulse)
        impulse = dt * (grid.force - self._before) if forces else grid.momentum - self._before
        about = self.state.centres_of_mass if self.about is None else np.tile(self.about, (bodies, 1))
        arm = grid.position - np.repeat(about, np.diff(grid.offset), axis=0)
        self.impulse += np.add.reduceat(cross(arm, impulse), grid.offset[:-1])
