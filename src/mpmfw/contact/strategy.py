"""Base of contact strategies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from mpmfw.plugin.base import PlugIn
from mpmfw.state.structs import Pair


class ContactStrategy(PlugIn):
    """Base of contact strategies.

    Subclasses implement the hooks of their place in the step. Their series are those of
    :data:`mpmfw.state.fields.CONTACT_SERIES` as far as they declare them.
    """

    #: One velocity field for all bodies, or one per body.
    velocity_fields: ClassVar[Literal["single", "per_body"]] = "per_body"
    #: Whether the strategy acts through tracked outlines (``state.surface``), which it then pays for.
    needs_surface: ClassVar[bool] = False
    #: How surface nodes are mapped to the grid: ``auto`` follows the shape function.
    surface_map: Literal["auto", "plain", "mass_weighted"] = "auto"
    #: Whether the strategy adds inertia to the nodes, which counts in a body's rotational inertia.
    adds_mass: bool = False
    #: Whether the strategy is to keep bodies apart, so that results warn of deep penetration.
    keeps_apart: ClassVar[bool] = True
    #: Whether the strategy uses the pairs' friction.
    uses_friction: ClassVar[bool] = False
    #: Whether the scene's ``contact.friction_law`` sets that friction, and not Coulomb's law alone.
    takes_friction_law: ClassVar[bool] = False
    #: Whether bodies at rest may be left out for a while (``[sleep]``): its history is in declared arrays, or
    #: copied by ``copy_history``.
    leaves_bodies_out: bool = False
    #: Dotted key of the scene that makes the strategy softer, for advice; None where nothing does.
    softer_by: str | None = None

    def parts(self) -> list[Any]:
        """Plug-ins that the strategy's options call for beside it, registered with it."""
        return []

    def reach(self, cell_size: float) -> float | None:  # noqa: ARG002
        """Return the distance of two bodies' boxes [m] beyond which nothing is searched; None without a
        search. ``cell_size`` is h [m]."""
        return None

    def unused(self, pairs: Sequence[Pair]) -> list[str]:  # noqa: ARG002
        """Return facts of these pairs that have no effect with its options, one line each, for ``explain``;
        that it has no friction follows from :attr:`uses_friction`."""
        return []

    def monitors(self) -> list[Any]:
        """Plug-ins that watch the strategy's own stability, registered where a scene says
        ``output.stability``."""
        return []

    def restart(self) -> None:
        """Time zero, after settling: forget accumulated work and impulse, keep the state of contact."""


class NoInteraction(ContactStrategy):
    """A velocity field for each body without interaction, as a reference of checks and measurements."""

    name = "no-interaction"
    velocity_fields = "per_body"
    keeps_apart = False
