"""Cohesive friction: what holds along an interface without a normal force."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from mpmfw.api import ContactRows, FloatArray, FrictionLaw, Pressure


class MohrCoulombOptions(BaseModel):
    """Shear strength of the interface."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    cohesion: Pressure = Field(
        gt=0, description="shear strength of the interface under no normal stress; no default"
    )


class MohrCoulomb(FrictionLaw):
    """T = μ N + c A: shear strength τ = c + σ_n tan φ of an interface, μ = tan φ; with μ = 0 that of
    undrained clay.

    A is the row's area across the normal. A row holds while it overlaps, or is pressed where no gap is
    measured; tension it never bears.
    """

    name = "mohr_coulomb"
    cohesive = True
    Options = MohrCoulombOptions
    options: MohrCoulombOptions

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:
        """The pairs' μ, and c A."""
        super().slip_limit(rows, friction, dt)
        n = rows.count
        rows.cohesion[:n] = self.options.cohesion * rows.area[:n]
