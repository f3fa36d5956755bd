"""No contact algorithm: the material point method's own, inherent no-slip sticking."""

from __future__ import annotations

from mpmfw.api import ContactStrategy


class NoContact(ContactStrategy):
    """All bodies share one velocity field: they stick where they meet, without slip and without separation.

    What they exchange at shared nodes cannot be told from internal force, so no contact force is reported.
    """

    name = "none"
    velocity_fields = "single"
