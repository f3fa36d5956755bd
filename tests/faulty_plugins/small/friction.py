"""Friction laws that are wrong in one place."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import BaseModel, Field

from faulty_plugins.sealed import Sealed
from mpmfw.api import ContactRows, FloatArray, FrictionLaw


class Sound(FrictionLaw):
    """μ falls with the speed of the slip, by half at 1 m/s."""

    name = "sound"

    def __init_subclass__(cls, **keywords: Any) -> None:
        """Name a plug-in with a fault as its class is called."""
        super().__init_subclass__(**keywords)
        if "name" not in vars(cls):
            cls.name = cls.__name__

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:
        super().slip_limit(rows, friction, dt)
        n = rows.count
        rows.friction[:n] /= 1.0 + self.speed(rows, dt)

    def speed(self, rows: ContactRows, dt: float) -> FloatArray:
        """Of the slip [m/s]."""
        n = rows.count
        along = (rows.motion[:n] * rows.normal[:n]).sum(axis=1)[:, None] * rows.normal[:n]
        slip: FloatArray = np.linalg.norm(rows.motion[:n] - along, axis=1)
        return slip / dt if dt > 0.0 else 0.0 * slip


class GrowthOptions(BaseModel, extra="forbid", frozen=True):
    """How much friction grows, and over which speed [m/s], which acts with a growth alone."""

    growth: float = Field(0.0, ge=0)
    velocity: float = Field(0.01, gt=0)


class OneNumberNeedsAnother(Sound):
    """μ grows with the logarithm of the speed, by nothing unless it is told to; sound as well."""

    Options = GrowthOptions

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:
        FrictionLaw.slip_limit(self, rows, friction, dt)
        growth = self.options.growth * np.log1p(self.speed(rows, dt) / self.options.velocity)
        rows.friction[: rows.count] *= 1.0 + growth


class DividesByNothing(Sound):
    """Forgets that the first step has no last one."""

    def speed(self, rows: ContactRows, dt: float) -> FloatArray:
        with np.errstate(all="ignore"):
            slip: FloatArray = np.linalg.norm(rows.motion[: rows.count], axis=1) / dt
        return slip


class TurnsNormals(Sound):
    """Writes the normals anew."""

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:
        super().slip_limit(rows, friction, dt)
        rows.normal[: rows.count] *= 1.0 + 1e-9


class FirstPair(Sound):
    """All pairs have the friction of the first."""

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:
        super().slip_limit(rows, np.full_like(friction, friction[0]), dt)


class WearsOut(Sound):
    """Falls with every call."""

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:
        self.calls = getattr(self, "calls", 0) + 1
        super().slip_limit(rows, friction / self.calls, dt)


class AlongX(Sound):
    """Knows the motion along x alone."""

    def speed(self, rows: ContactRows, dt: float) -> FloatArray:
        slip: FloatArray = np.abs(rows.motion[: rows.count, 0])
        return slip / dt if dt > 0.0 else 0.0 * slip


class ByTheStep(Sound):
    """Takes the motion over a step, times 10 000, for the speed."""

    def speed(self, rows: ContactRows, dt: float) -> FloatArray:  # noqa: ARG002
        return super().speed(rows, 1e-4)


class Factor(BaseModel):
    """An option that a reader would set."""

    factor: float = 1.0


class Dropped(Sound):
    """Accepts an option and drops it."""

    Options = Factor


class WholeMotion(Sound):
    """Takes the approach for slip as well."""

    def speed(self, rows: ContactRows, dt: float) -> FloatArray:
        moved: FloatArray = np.linalg.norm(rows.motion[: rows.count], axis=1)
        return moved / dt if dt > 0.0 else 0.0 * moved


class ByArea(Sound):
    """A large row has more of it."""

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:
        super().slip_limit(rows, friction, dt)
        rows.friction[: rows.count] *= 1.0 + rows.area[: rows.count]


class Closed(Sealed, Sound):
    """Holds a function."""
