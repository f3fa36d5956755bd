"""Separate velocity fields without interaction: bodies pass through each other."""

from __future__ import annotations

from mpmfw.api import ContactStrategy


class Separate(ContactStrategy):
    """One velocity field per body and no interaction; the opposite baseline of ``none``."""

    name = "separate"
    velocity_fields = "per_body"
    keeps_apart = False
