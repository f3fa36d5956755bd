"""Mohr and Coulomb's plasticity of soils at finite strain; plane strain in 2D."""

from __future__ import annotations

import math

from mpmfw_material._frictional import Frictional


class MohrCoulomb(Frictional):
    """Strength (σ₁ − σ₃) / 2 = c cos φ − (σ₁ + σ₃) / 2 sin φ, tension positive, in Kirchhoff's stress.

    The plastic potential has the same planes with the angle of dilation ψ. Perfectly plastic. At the apex, or
    at ``tension``, the volume flows freely.
    """

    name = "mohr_coulomb"
    cone = False

    def surface(self) -> tuple[float, float, float]:
        """sin φ, sin ψ and 2 c cos φ."""
        o = self.options
        return (
            math.sin(o.friction_angle),
            math.sin(o.dilation_angle),
            2.0 * o.cohesion * math.cos(o.friction_angle),
        )
