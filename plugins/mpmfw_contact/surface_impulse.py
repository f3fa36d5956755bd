"""Contact of tracked surfaces by impulses, row by row: no stiffness, no history, no step limit of its own."""

from __future__ import annotations

from mpmfw.contact.surfaces import Surfaces
from mpmfw_contact.impulse import Impulse


class SurfaceImpulse(Impulse):
    """What approaches at a surface node is stopped, with Coulomb friction; what overlaps is not pushed apart.

    Detection is that of ``penalty``, the impulses are those of ``bardenhagen``: of the two it has one each.
    """

    Detection = Surfaces
