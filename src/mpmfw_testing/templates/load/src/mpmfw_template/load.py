"""A force on every material point: replace it by your own."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from mpmfw.api.load import BodyLoad
from mpmfw.api.types import FloatArray, Particles
from mpmfw.api.units import Acceleration, TimeTable, problems_in_time, vector_in_time


class TemplateOptions(BaseModel):
    """Acceleration [m/s^2]: a vector, or rows (t, x, y[, z])."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    acceleration: vector_in_time(Acceleration) | None = None  # type: ignore[valid-type]


class Template(BodyLoad):
    """f_p = m_p a(t), and nothing where no acceleration is given."""

    name = "template"
    Options = TemplateOptions
    options: TemplateOptions

    @classmethod
    def problems(cls, options: Any, dim: int) -> Iterable[tuple[tuple[str | int, ...], str]]:
        """An acceleration of another dimension than the grid, and times that do not increase."""
        if options.acceleration is None:
            return ()
        return ((("acceleration", *i), said) for i, said in problems_in_time(options.acceleration, dim))

    def forces(self, particles: Particles, own: slice, time: float) -> FloatArray:
        """Force on each of the points ``own`` of ``particles`` at a ``time`` [s], (n, dim) [N]."""
        given = self.options.acceleration
        acceleration = np.zeros(particles.dim) if given is None else TimeTable.of(given).at(time)
        force: FloatArray = particles.mass[own, None] * acceleration
        return force
