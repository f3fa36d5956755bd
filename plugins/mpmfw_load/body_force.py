"""A force by volume, constant or changing in time."""

from __future__ import annotations

from typing import Any

from mpmfw.api.load import BodyLoad
from mpmfw.api.types import FloatArray, OptionsModel, Particles
from mpmfw.api.units import TimeTable, quantity, vector_in_time


class BodyForceOptions(OptionsModel):
    """Options of a body force.

    Attributes
    ----------
    force
        By volume of the undeformed body [N/m^3]: a vector, or rows (t, x, y[, z]).
    """

    force: vector_in_time(quantity("N/m^3"))  # type: ignore[valid-type]


class BodyForce(BodyLoad):
    """The same force on every part of the undeformed volume, f_p = V_p⁰ b(t)."""

    name = "body_force"
    Options = BodyForceOptions
    options: BodyForceOptions
    vectors = ("force",)

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.table = TimeTable.of(self.options.force)

    def forces(self, particles: Particles, own: slice, time: float) -> FloatArray:
        """V_p⁰ b(t), (n, dim) [N]."""
        volume = particles.times_thickness(particles.initial_volume)[own]
        force: FloatArray = volume[:, None] * self.table.at(time)
        return force
