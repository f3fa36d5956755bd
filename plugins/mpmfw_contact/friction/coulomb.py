"""Coulomb's friction, by its name."""

from __future__ import annotations

from mpmfw.api import FrictionLaw


class Coulomb(FrictionLaw):
    """T = μ N with the μ of each pair: what contact has where no law is named."""

    name = "coulomb"
    is_coulomb = True
