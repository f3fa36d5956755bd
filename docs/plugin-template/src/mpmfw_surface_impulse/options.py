"""Options of the surface impulses: the table ``[contact.surface_impulse]`` of a scene."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator


class SurfaceImpulseOptions(BaseModel):
    """Roles of the bodies, what happens to existing penetration, search, and the solver's accuracy."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    passes: Literal["one", "two"] = Field(
        "two",
        description="two: the nodes of both bodies are held off the other's segments; one: of the slave alone",
    )
    slave: str | None = Field(
        None,
        description="name of the slave body (passes = one); default: the softer, else a pair's second body",
    )
    restore: float = Field(
        0.01, ge=0, le=1, description="part of a penetration that is there already which one step takes back"
    )
    search_radius: float = Field(0.5, gt=0, le=1, description="reach of the search in cells")
    tolerance: float = Field(
        1e-6,
        gt=0,
        le=1e-3,
        description="largest change of a gap in the last sweep, in cells, that ends the solution",
    )
    sweeps: int = Field(200, ge=1, description="most sweeps of the solver in one step")

    @model_validator(mode="after")
    def _options_have_an_effect(self) -> SurfaceImpulseOptions:
        if self.slave is not None and self.passes != "one":
            raise ValueError('\'slave\' has no effect with passes = "two"; expected passes = "one"')
        return self
