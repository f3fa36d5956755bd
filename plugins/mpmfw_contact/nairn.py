"""Contact at shared nodes with normal and separation by logistic regression (Nairn, Hammerquist & Smith
2020)."""

from __future__ import annotations

from mpmfw.api import ImpulseContact
from mpmfw_contact.impulse import Impulse
from mpmfw_contact.logistic import Logistic


class Nairn(ImpulseContact):
    """Momentum exchange at grid nodes whose two bodies approach and overlap across the plane between their
    points.

    Both the projected and the updated momentum are corrected, as published.
    """

    name = "nairn"
    Detection = Logistic
    Law = Impulse
