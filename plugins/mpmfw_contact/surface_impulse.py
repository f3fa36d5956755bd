"""Contact of tracked surfaces by impulses, row by row: without stiffness, history or limit of the step."""

from __future__ import annotations

from mpmfw.contact.surfaces import Surfaces
from mpmfw_contact.impulse import Impulse


class SurfaceImpulse(Impulse):
    """Approach at surface nodes is stopped, with Coulomb friction; overlaps are not pushed apart."""

    Detection = Surfaces
