"""Table of the stress that soil begins with."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import Field, Strict, model_validator

from mpmfw.scene.base import Table
from mpmfw.units import Density, Length, Number, Pressure

#: A depth, and vertical and horizontal pressure there.
StressRow = Annotated[tuple[Annotated[Length, Field(ge=0)], Pressure, Pressure], Strict(False)]


class InitialStress(Table):
    """Stress of soil at the start by depth below ``top`` [m], that of the body's box without one.

    Vertical it is the weight of what lies above, of a ``density`` [kg/m^3], the body's without one, and
    horizontal ``k0`` times that. Or a ``table`` of rows (depth [m], vertical, horizontal pressure [Pa])."""

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
