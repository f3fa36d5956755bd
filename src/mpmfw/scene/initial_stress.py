"""Table of the initial stress of soil."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import Field, Strict, model_validator

from mpmfw.scene.base import Table
from mpmfw.units import Density, Length, Number, Pressure

#: A depth, and vertical and horizontal pressure there.
StressRow = Annotated[tuple[Annotated[Length, Field(ge=0)], Pressure, Pressure], Strict(False)]


class InitialStress(Table):
    """Initial stress of soil by depth below ``top`` [m], by default the top of the body's box.

    The vertical stress is the weight above, with the ``density`` [kg/m^3] or by default the body's; the
    horizontal stress is ``k0`` times that. Alternatively ``table`` has rows (depth [m], vertical, horizontal
    pressure [Pa])."""

    k0: Annotated[Number, Field(ge=0)] | None = None
    density: Annotated[Density, Field(gt=0)] | None = None
    top: Length | None = None
    table: Annotated[tuple[StressRow, ...], Strict(False), Field(min_length=2)] | None = None

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        """Refuse both forms, neither, and depths out of order."""
        if (self.k0 is None) == (self.table is None) or (self.table and self.density is not None):
            raise ValueError("expected k0 or table; density goes with k0")
        if self.table is not None and np.any(np.diff([row[0] for row in self.table]) <= 0.0):
            raise ValueError("expected depths that increase from row to row of table")
        return self
