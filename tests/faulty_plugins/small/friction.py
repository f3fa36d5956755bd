"""Friction laws that are wrong in one place."""

import numpy as np
from pydantic import BaseModel, Field

from faulty_plugins.sealed import Named
from mpmfw.api import FrictionLaw


class Sound(Named, FrictionLaw):
    """μ falls with the speed of the slip, by half at 1 m/s."""

    name = "sound"

    def slip_limit(self, rows, friction, dt):
        super().slip_limit(rows, friction, dt)
        n = rows.count
        rows.friction[:n] /= 1.0 + self.speed(rows, dt)

    def speed(self, rows, dt):
        """Of the slip [m/s]."""
        n = rows.count
        along = (rows.motion[:n] * rows.normal[:n]).sum(axis=1)[:, None] * rows.normal[:n]
        slip = np.linalg.norm(rows.motion[:n] - along, axis=1)
        return slip / dt if dt > 0.0 else 0.0 * slip


class GrowthOptions(BaseModel, extra="forbid", frozen=True):
    """How much friction grows, and over which speed [m/s], which acts with a growth alone."""

    growth: float = Field(0.0, ge=0)
    velocity: float = Field(0.01, gt=0)


class OneNumberNeedsAnother(Sound):
    """μ grows with the logarithm of the speed, by nothing unless it is told to; sound as well."""

    Options = GrowthOptions

    def slip_limit(self, rows, friction, dt):
        FrictionLaw.slip_limit(self, rows, friction, dt)
        growth = self.options.growth * np.log1p(self.speed(rows, dt) / self.options.velocity)
        rows.friction[: rows.count] *= 1.0 + growth
