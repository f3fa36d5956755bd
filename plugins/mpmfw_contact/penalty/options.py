"""Options of the penalty contact."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from mpmfw.api import Length

#: [H17] to the letter: what ``variant = "hamad2017"`` sets at once.
HAMAD_2017: dict[str, Any] = {
    "passes": "one",
    "normal_variation": "hamad2017",
    "friction_law": "hamad2017",
    "detection": "hamad2017",
    "interface_thickness": 0.001,
}


class PenaltyOptions(BaseModel):
    """Stiffness, search, friction and mapping."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    variant: Literal["default", "hamad2017"] = Field(
        "default", description="hamad2017 sets [H17]'s literal form; keys given beside it win"
    )
    kappa: float = Field(
        1.0, gt=0, description="stiffness factor: k = kappa M l_trib / h, M the softer K + 4 G / 3"
    )
    tangential_ratio: float = Field(1.0, gt=0, description="k_t / k_n")
    passes: Literal["one", "two"] = Field(
        "two",
        description="two: each body is slave once, with half the stiffness; one: classical master-slave",
    )
    master: str | None = Field(
        None,
        description="name of the master body (passes = one); default: the stiffer, else a pair's first body",
    )
    normal_variation: Literal["exact", "hamad2017"] = Field(
        "exact", description="C_n = N, the exact variation, or N - (g_n / l) Q (eq. 7)"
    )
    friction_law: Literal["return_map", "hamad2017"] = Field(
        "return_map",
        description="stored force returned to Coulomb's cone, or uncapped increments of one step",
    )
    detection: Literal["closest_point", "hamad2017"] = Field(
        "closest_point",
        description="closest point of the polyline, or every segment with g_n < 0 and 0 <= xi <= 1",
    )
    search_radius: float = Field(1.0, gt=0, le=1.0, description="reach of the search in cells")
    interface_thickness: Length = Field(
        0.0, ge=0, description="thickness of the surface layer that carries mass"
    )
    damping: float = Field(0.0, ge=0, description="normal dashpot as a fraction of critical, at most 2 k dt")
    map: Literal["auto", "plain", "mass_weighted"] = Field(
        "auto", description="surface-to-grid map; auto: mass_weighted for linear and GIMP, else plain"
    )

    @model_validator(mode="before")
    @classmethod
    def _apply_variant(cls, values: Any) -> Any:
        if isinstance(values, dict) and values.get("variant") == "hamad2017":
            return {**HAMAD_2017, **values}
        return values

    @model_validator(mode="after")
    def _options_have_an_effect(self) -> PenaltyOptions:
        if self.master is not None and self.passes != "one":
            raise ValueError('\'master\' has no effect with passes = "two"; expected passes = "one"')
        if self.detection == "hamad2017" and self.friction_law != "hamad2017":
            raise ValueError(
                'detection = "hamad2017" may give a node several segments, and return_map keeps one force a body; '
                'expected friction_law = "hamad2017"'
            )
        return self
