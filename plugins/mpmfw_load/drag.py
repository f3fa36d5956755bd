"""Drag that goes with the velocity against a medium."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import Field

from mpmfw.api.load import BodyLoad
from mpmfw.api.types import FloatArray, OptionsModel, Particles, State, hookimpl
from mpmfw.api.units import TimeTable, Velocity, quantity, vector_in_time


class DragOptions(OptionsModel):
    """Options of drag.

    Attributes
    ----------
    rate
        c [1/s]: a body alone loses the share 1 − exp(−c t) of its velocity.
    medium
        Velocity u of the medium [m/s]: a vector, or rows (t, x, y[, z]); at rest where it is not given.
    """

    rate: Annotated[quantity("1/s"), Field(gt=0)]  # type: ignore[valid-type]
    medium: vector_in_time(Velocity) | None = None  # type: ignore[valid-type]


class Drag(BodyLoad):
    """Linear drag on every material point, f_p = −c m_p (v_p − u(t))."""

    name = "drag"
    Options = DragOptions
    options: DragOptions
    vectors = ("medium",)

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        medium = self.options.medium
        self.table = None if medium is None else TimeTable.of(medium)

    def forces(self, particles: Particles, own: slice, time: float) -> FloatArray:
        """−c m_p (v_p − u), (n, dim) [N]."""
        medium = np.zeros(particles.dim) if self.table is None else self.table.at(time)
        c, mass = self.options.rate, particles.mass[own, None]
        force: FloatArray = -c * mass * (particles.velocity[own] - medium)
        return force

    @hookimpl
    def stable_timestep(self, state: State) -> tuple[float, str] | None:  # noqa: ARG002
        """2 / c [s]: a longer step would turn the velocity round and make it grow."""
        return 2.0 / self.options.rate, "drag"
