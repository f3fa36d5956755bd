"""Gravity: a vector, a magnitude and a tilt, or a table in time."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from pydantic import Field, Strict

from mpmfw.scene.base import AccelerationVector, GravityRow, Table
from mpmfw.units import Acceleration, Angle


class ConstantGravity(Table):
    """Gravity as a vector [m/s^2], or a magnitude [m/s^2] with a tilt [rad] that drives bodies towards +x."""

    vector: AccelerationVector | None = None
    magnitude: Annotated[Acceleration, Field(gt=0)] | None = None
    tilt: Angle | None = None

    def at(self, time: float) -> tuple[float, ...]:  # noqa: ARG002  (the same call as for a table)
        """Components (dim,) [m/s^2]: the vector, or g (sin θ, -cos θ)."""
        if self.vector is not None:
            return tuple(self.vector)
        g, tilt = self.magnitude or 0.0, self.tilt or 0.0
        return g * math.sin(tilt), -g * math.cos(tilt)

    @property
    def is_constant(self) -> bool:
        """Return True if it is the same at all times."""
        return True


class Gravity(ConstantGravity):
    """Constant gravity, or ``table``: rows (t, g_x, g_y[, g_z]), linear in between and constant outside."""

    table: Annotated[tuple[GravityRow, ...], Strict(False), Field(min_length=2)] | None = None

    def at(self, time: float) -> tuple[float, ...]:
        """Components (dim,) [m/s^2] at ``time`` [s]."""
        if self.table is None:
            return super().at(time)
        times, *components = np.array(self.table).T
        return tuple(float(np.interp(time, times, values)) for values in components)

    @property
    def is_constant(self) -> bool:
        """Return True if it is the same at all times."""
        return self.table is None
