"""A force on every material point: replace it by your own."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from mpmfw.api.load import BodyLoad
from mpmfw.api.types import FloatArray, Particles


class TemplateOptions(BaseModel):
    """How fast the motion decays [1/s]."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    rate: float = Field(1.0, ge=0)


class Template(BodyLoad):
    """f_p = −rate m_p v_p."""

    name = "template"
    Options = TemplateOptions
    options: TemplateOptions

    def forces(self, particles: Particles, own: slice, time: float) -> FloatArray:  # noqa: ARG002
        """Return the force on each of the points ``own`` of ``particles`` at a ``time`` [s], (n, dim) [N]."""
        force: FloatArray = -self.options.rate * particles.mass[own, None] * particles.velocity[own]
        return force
