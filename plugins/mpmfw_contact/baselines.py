"""The two opposite baselines: bodies that stick together, and bodies that pass through each other."""

from __future__ import annotations

from mpmfw.api import ContactStrategy


class NoContact(ContactStrategy):
    """All bodies share one velocity field: they stick where they meet, without slip and without separation.

    That is the material point method's own contact. What bodies exchange at shared nodes cannot be told from
    internal force, so no contact force is reported.
    """

    name = "none"
    velocity_fields = "single"


class Separate(ContactStrategy):
    """One velocity field per body and no interaction."""

    name = "separate"
    velocity_fields = "per_body"
    keeps_apart = False
