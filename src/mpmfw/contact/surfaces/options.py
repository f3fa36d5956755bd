"""Options of the detections that work with facets."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from mpmfw.units import Length


class FacetOptions(BaseModel):
    """Master, search and mapping."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    master: str | None = Field(
        None,
        description="name of the master body (one pass); default: the stiffer; of equally stiff ones that "
        "with the "
        "larger surface; of equals each is slave once",
    )
    search_radius: float = Field(1.0, gt=0, le=1.0, description="reach of the search in cells")
    interface_thickness: Length = Field(
        0.0, ge=0, description="thickness of the surface layer that carries mass"
    )
    map: Literal["auto", "plain", "mass_weighted"] = Field(
        "auto", description="surface-to-grid map; auto: mass_weighted for linear and GIMP, else plain"
    )


class SurfacesOptions(FacetOptions):
    """Master, search and mapping, number of passes, and the form of C_n."""

    passes: Literal["one", "two"] = Field(
        "two",
        description="two: each body is slave once, with half of its area; one: classical master-slave, "
        "but of equal bodies",
    )
    normal_variation: Literal["exact", "hamad2017"] = Field(
        "exact", description="C_n = N, the exact variation, or N - (g_n / l) Q (eq. 7)"
    )

    @model_validator(mode="after")
    def _master_has_an_effect(self) -> SurfacesOptions:
        if self.master is not None and self.passes != "one":
            raise ValueError('\'master\' has no effect with passes = "two"; expected passes = "one"')
        return self
