"""Drucker and Prager's plasticity of soils at finite strain; plane strain in 2D."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field

from mpmfw_material._frictional import Frictional, FrictionalOptions


class DruckerPragerOptions(FrictionalOptions):
    fit: Literal["plane_strain", "compression", "extension"] = Field(
        "plane_strain",
        description="test in which the strength is that of Mohr and Coulomb: plane strain, or triaxial "
        "compression or extension",
    )


class DruckerPrager(Frictional):
    """Strength √J₂ = k − η p, p the mean stress, tension positive, in Kirchhoff's stress.

    η and k follow from c and φ, and η̄ of the plastic potential from ψ, so that the test named by ``fit``
    gives the strength and the dilation of ``mohr_coulomb``. Perfectly plastic.
    """

    name = "drucker_prager"
    cone = True
    Options = DruckerPragerOptions
    options: DruckerPragerOptions

    def surface(self) -> tuple[float, float, float]:
        """η, η̄ and k."""
        o = self.options
        dilation = self._slope(o.dilation_angle, None)[0]
        friction, factor = self._slope(o.friction_angle, dilation)
        return friction, dilation, factor * o.cohesion * math.cos(o.friction_angle)

    def _slope(self, angle: float, dilation: float | None) -> tuple[float, float]:
        """Return η of an angle and k / (c cos φ); a ``dilation`` of None is that of the same angle.

        Plane strain: no flow across the plane makes the stress there s₃ = −2 η̄ √J₂ / 3, and the radius of
        Mohr's circle √J₂ √(1 − η̄² / 3).
        """
        sine = math.sin(angle)
        if self.options.fit == "plane_strain":
            if dilation is None:
                dilation = 3.0 * math.tan(angle) / math.sqrt(9.0 + 12.0 * math.tan(angle) ** 2)
            factor = 1.0 / (math.sqrt(1.0 - dilation**2 / 3.0) + sine * dilation / 3.0)
        else:
            sign = -1.0 if self.options.fit == "compression" else 1.0
            factor = 6.0 / (math.sqrt(3.0) * (3.0 + sign * sine))
        return factor * sine, factor
