"""Options of contact by springs between surfaces, and those of the penalty contact."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from mpmfw.api import Length

#: Options of [H17]'s own form, which is a method of its own.
MOVED = ("variant", "friction_law", "detection")


class SurfaceOptions(BaseModel):
    """Stiffness, roles, search and mapping."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    kappa: float = Field(
        1.0, gt=0, description="stiffness factor: k = kappa M l_trib / h, M the softer K + 4 G / 3"
    )
    tangential_ratio: float = Field(1.0, gt=0, description="k_t / k_n")
    master: str | None = Field(
        None,
        description="name of the master body (one pass); default: the stiffer, else a pair's first body",
    )
    search_radius: float = Field(1.0, gt=0, le=1.0, description="reach of the search in cells")
    interface_thickness: Length = Field(
        0.0, ge=0, description="thickness of the surface layer that carries mass"
    )
    map: Literal["auto", "plain", "mass_weighted"] = Field(
        "auto", description="surface-to-grid map; auto: mass_weighted for linear and GIMP, else plain"
    )


class PenaltyOptions(SurfaceOptions):
    """Those, and passes, the form of C_n and a dashpot."""

    passes: Literal["one", "two"] = Field(
        "two",
        description="two: each body is slave once, with half the stiffness; one: classical master-slave",
    )
    normal_variation: Literal["exact", "hamad2017"] = Field(
        "exact", description="C_n = N, the exact variation, or N - (g_n / l) Q (eq. 7)"
    )
    damping: float = Field(0.0, ge=0, description="normal dashpot as a fraction of critical, at most 2 k dt")

    @model_validator(mode="before")
    @classmethod
    def _own_form_is_a_method(cls, values: Any) -> Any:
        for name in MOVED if isinstance(values, dict) else ():
            if name in values:
                raise ValueError(
                    f"'{name}' is no option of penalty: [H17] by its equations is a contact method of its own, "
                    'contact.method = "hamad2017"'
                )
        return values

    @model_validator(mode="after")
    def _options_have_an_effect(self) -> PenaltyOptions:
        if self.master is not None and self.passes != "one":
            raise ValueError('\'master\' has no effect with passes = "two"; expected passes = "one"')
        return self
