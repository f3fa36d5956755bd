"""Contact of multiple velocity fields (Bardenhagen, Brackbill & Sulsky 2000; Bardenhagen et al. 2001)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from mpmfw.api import ImpulseContact
from mpmfw_contact.impulse import Impulse
from mpmfw_contact.nodes import Nodes, NodesOptions


class BardenhagenOptions(NodesOptions):
    """Criterion of contact and kind of normal."""

    criterion: Literal["velocity", "position"] = Field(
        "velocity",
        description="velocity: bodies approach at a shared node (2000, 2001); position: and their extrapolated "
        "positions are closer than the cut-off",
    )


class Bardenhagen(ImpulseContact):
    """Momentum exchange at grid nodes that two bodies share, with Coulomb friction.

    At a shared node with approaching bodies the relative velocity along the normal is taken away, and the
    tangential one as far as Coulomb's cone lets it. Both the projected and the updated momentum are
    corrected.
    """

    name = "bardenhagen"
    Detection = Nodes
    Law = Impulse
    Options = BardenhagenOptions
    leaves_bodies_out = True
