"""Base classes of contact: detections and laws, whose rows the core keeps, friction laws, and whole
strategies.

``CONTACT_SERIES``
    Declarations (:class:`mpmfw.api.types.Field`) of the series that contact strategies may record, one value
    a pair: contact_force and friction_force [N/m], contact_count, frictional_work, contact_energy and
    damping_work [J/m].
"""

from __future__ import annotations

from mpmfw.contact.forces import ForceLaw, ImpulseLaw
from mpmfw.contact.law import ContactLaw, PairRecords
from mpmfw.contact.rows import ContactRows, Detection, FrictionLaw
from mpmfw.contact.strategy import ContactStrategy
from mpmfw.state.fields import CONTACT_SERIES

__all__ = [
    "CONTACT_SERIES",
    "ContactLaw",
    "ContactRows",
    "ContactStrategy",
    "Detection",
    "ForceLaw",
    "FrictionLaw",
    "ImpulseLaw",
    "PairRecords",
]
