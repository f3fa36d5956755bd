"""Contact of material points as spheres (Xiao, Liu & Sun 2021; de Vaucorbeil & Nguyen 2021)."""

from __future__ import annotations

from mpmfw.api import ForceContact
from mpmfw_contact.penalty import PenaltyLaw, PenaltyLawOptions
from mpmfw_contact.points import PointSpheres


class ParticleContact(ForceContact):
    """Springs between points of different bodies that are nearer than the sum of their radii, with friction and a history.

    The springs are those of ``penalty``, so that the two differ by detection alone.
    """

    name = "particles"
    Detection = PointSpheres
    Law = PenaltyLaw
    Options = PenaltyLawOptions
