"""Base classes of contact: detections and laws, whose rows the core keeps, friction laws, and whole
strategies.

``CONTACT_SERIES``
    Declarations (:class:`mpmfw.api.types.Field`) of the series that contact strategies may record, one value
    a pair: contact_force and friction_force [N/m], contact_count, frictional_work, contact_energy and
    damping_work [J/m].
"""

from __future__ import annotations

from mpmfw.contact.force_contact import ForceContact, ForceLaw
from mpmfw.contact.impulse_contact import ImpulseContact, ImpulseLaw
from mpmfw.contact.parts import ContactLaw, Detection
from mpmfw.contact.row_contact import PairRecords
from mpmfw.contact.rows import ContactRows, FrictionLaw
from mpmfw.contact.strategy import ContactStrategy
from mpmfw.state.fields import CONTACT_SERIES

__all__ = [
    "CONTACT_SERIES",
    "ContactLaw",
    "ContactRows",
    "ContactStrategy",
    "Detection",
    "ForceContact",
    "ForceLaw",
    "FrictionLaw",
    "ImpulseContact",
    "ImpulseLaw",
    "PairRecords",
]
