"""Particles: how a body is divided into material points."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from mpmfw.geometry.plane import PositiveLength

Fraction = Annotated[float, Field(ge=0.0, lt=1.0, allow_inf_nan=False)]


class Particles(BaseModel):
    """How a body is divided into material points.

    Attributes
    ----------
    layout
        ``lattice``: square cells clipped by the outline. ``fitted``: quadrilaterals that follow the outline.
    size
        Wanted largest edge of a domain [m]. Pieces merged at a clipped outline, and the outer cells of a
        fitted ring, are slightly larger; a fitted mesh file keeps its own elements.
    offset
        Shift of the lattice along each axis, in fractions of a cell; directions not given are not shifted.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    layout: Literal["lattice", "fitted"] = "lattice"
    size: PositiveLength
    offset: tuple[Fraction, ...] = Field(default=(), max_length=3)

    @model_validator(mode="after")
    def _offset_needs_a_lattice(self) -> Self:
        if self.layout == "fitted" and any(self.offset):
            raise ValueError(
                "offset shifts a lattice; a fitted layout follows the outline and has none to shift"
            )
        return self

    def offset_in(self, dim: int) -> tuple[float, ...]:
        """The offset as ``dim`` fractions.

        Raises
        ------
        ValueError
            More fractions are given than the body has dimensions.
        """
        if len(self.offset) > dim:
            raise ValueError(f"offset has {len(self.offset)} entries for a body in {dim}D")
        return self.offset + (0.0,) * (dim - len(self.offset))
