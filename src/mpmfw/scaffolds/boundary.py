"""Motion that is prescribed by time and place: replace it by your own."""

from __future__ import annotations

import numpy as np
from pydantic import BaseModel, ConfigDict

from mpmfw.api import AnyArray, Boundary, FloatArray, Length, Velocity


class TemplateOptions(BaseModel):
    """Points below a height [m] move along x with a speed [m/s]."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    below: Length = 0.0
    speed: Velocity = 0.0


class Template(Boundary):
    """The lower part of the bodies slides along x, and is held in all other directions."""

    name = "template"
    Options = TemplateOptions
    options: TemplateOptions

    def holds(self, position: FloatArray) -> AnyArray:
        """Which of the points at ``position`` (n, dim) [m] are held, (n,)."""
        held: AnyArray = position[:, 1] < self.options.below
        return held

    def velocity(self, position: FloatArray, time: float) -> FloatArray:  # noqa: ARG002
        """Velocity at ``position`` (n, dim) [m] and ``time`` [s], (n, dim) [m/s]; NaN would leave a component free."""
        velocity = np.zeros_like(position)
        velocity[:, 0] = self.options.speed
        return velocity
