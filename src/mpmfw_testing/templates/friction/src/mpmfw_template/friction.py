"""Friction of rows of contact: replace the bound by your own."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from mpmfw.api.contact import ContactRows, FrictionLaw
from mpmfw.api.types import FloatArray


class TemplateOptions(BaseModel):
    """A factor on Coulomb's coefficient [1]."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    factor: float = Field(1.0, ge=0)


class Template(FrictionLaw):
    """Coulomb's friction with the pair's μ times a factor."""

    name = "template"
    Options = TemplateOptions
    options: TemplateOptions

    def slip_limit(self, rows: ContactRows, friction: FloatArray, dt: float) -> None:
        """Write ``rows.friction`` (n,) [1]; ``friction`` is μ of every pair (n_pairs,) [1], ``dt`` the last
        step [s]."""
        super().slip_limit(rows, friction, dt)
        rows.friction[: rows.count] *= self.options.factor
