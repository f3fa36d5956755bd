"""Friction laws: μ and cohesion of every row of contact."""

from __future__ import annotations

import math

from pydantic import Field

from mpmfw.api import ContactRows, FloatArray, FrictionLaw, OptionsModel, Pressure, Velocity
from mpmfw.kernels import kernel
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.types import Floats


class Coulomb(FrictionLaw):
    """T = μ N with the μ of each pair: what contact has where no law is named."""

    name = "coulomb"
    is_coulomb = True


class MohrCoulombOptions(OptionsModel):
    cohesion: Pressure = Field(
        gt=0, description="shear strength of the interface under no normal stress; no default"
    )


class MohrCoulomb(FrictionLaw):
    """T = μ N + c A: shear strength τ = c + σ_n tan φ of an interface; with μ = 0 that of undrained clay.

    A is the row's area across the normal. A row holds while it overlaps, or is pressed where no gap is
    measured.
    """

    name = "mohr_coulomb"
    cohesive = True
    Options = MohrCoulombOptions
    options: MohrCoulombOptions

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:
        super().slip_limit(rows, friction, dt)
        n = rows.count
        rows.cohesion[:n] = self.options.cohesion * rows.area[:n]


@kernel
def weaken(rows: Rows, count: int, friction: Floats, ratio: float, velocity: float, dt: float) -> None:
    """μ [1 + (r − 1) e^(−|v_t| / v_c)] of every row, v_t Δt the part of its motion across the normal."""
    dim = rows.normal.shape[1]
    for c in range(count):
        along, square = 0.0, 0.0
        for d in range(dim):
            along += rows.motion[c, d] * rows.normal[c, d]
            square += rows.motion[c, d] * rows.motion[c, d]
        speed = math.sqrt(max(square - along * along, 0.0)) / dt if dt > 0.0 else 0.0
        rows.friction[c] = friction[rows.pair[c]] * (1.0 + (ratio - 1.0) * math.exp(-speed / velocity))


class StribeckOptions(OptionsModel):
    static_ratio: float = Field(
        1.5, ge=0, description="static over kinetic friction; below 1 friction grows with the slip"
    )
    velocity: Velocity = Field(
        gt=0,
        description="slip velocity at which 1/e of their difference is left; no default, since it is the "
        "surfaces' own",
    )


class Stribeck(FrictionLaw):
    """μ(v) = μ [1 + (r − 1) e^(−v / v_c)]: a pair's ``friction`` is the kinetic one, r times as much holds at
    rest.

    The exponential form of Bo & Pavelescu (1982) with the exponent 1. v is the slip velocity of the step
    before; springs stick with small motions, and v_c is to be well above them.
    """

    name = "stribeck"
    Options = StribeckOptions
    options: StribeckOptions

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:
        options = self.options
        weaken(rows, rows.count, friction, options.static_ratio, options.velocity, dt)
