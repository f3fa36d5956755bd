"""Box."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator

from mpmfw.geometry.layout import FloatArray, IntArray, Layout
from mpmfw.geometry.plane import Point3D
from mpmfw.geometry.tiling import tiling
from mpmfw.geometry.triangles import box_surface


class Box(BaseModel):
    """A cuboid between two corners [m], edges along the axes."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    dim: ClassVar[int] = 3
    is_connected: ClassVar[bool] = True

    type: Literal["box"] = "box"
    lower: Point3D
    upper: Point3D

    @model_validator(mode="after")
    def _lower_below_upper(self) -> Self:
        if not all(a < b for a, b in zip(self.lower, self.upper, strict=True)):
            raise ValueError(f"lower {self.lower} must be below upper {self.upper} in every direction")
        return self

    @property
    def exact_volume(self) -> float:
        """Product of the edges [m^3]."""
        return float(np.prod(np.subtract(self.upper, self.lower)))

    @property
    def centroid(self) -> FloatArray:
        """The centre (3,) [m]."""
        return 0.5 * np.add(self.lower, self.upper)

    @property
    def axes(self) -> FloatArray:
        """Unit vectors along the edges, one a row (3, 3)."""
        return np.eye(3)

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner (2, 3) [m]."""
        return np.array([self.lower, self.upper])

    def surfaces(self, edge: float) -> tuple[tuple[FloatArray, IntArray], ...]:
        """Nodes (n, 3) [m] and triangles (k, 3): rectangles of sides up to ``edge`` [m], cut in four from the centre."""
        return (box_surface(self.bounds[0], self.bounds[1], edge),)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """The tiling, shifted by ``offset`` (fractions of a cell)."""
        return tiling(self.lower, self.upper, size, offset)

    def fitted(self, size: float) -> Layout:
        """The tiling."""
        return tiling(self.lower, self.upper, size, (0.0, 0.0, 0.0))
