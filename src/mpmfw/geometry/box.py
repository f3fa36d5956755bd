"""Box."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import model_validator

from mpmfw.geometry.layout import FloatArray, Layout
from mpmfw.geometry.plane import Point3D
from mpmfw.geometry.solid import SolidGeometry, Surfaces, Turns, turning
from mpmfw.geometry.tiling import tiling
from mpmfw.geometry.triangles import box_surface


class Box(SolidGeometry):
    """A cuboid between two corners [m], turned about its centre by ``angles`` [rad] about x, then y, then z."""

    has_plane_faces: ClassVar[bool] = True

    type: Literal["box"] = "box"
    lower: Point3D
    upper: Point3D
    angles: Turns = (0.0, 0.0, 0.0)

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
        """Unit vectors along the edges, one a row (3, 3): sides turn with the box."""
        return turning(self.angles).T

    @property
    def width(self) -> float:
        """The shortest edge [m]."""
        return float(np.subtract(self.upper, self.lower).min())

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 3) [m]."""
        if not any(self.angles):
            return np.array([self.lower, self.upper])
        half = np.abs(turning(self.angles)) @ (0.5 * np.subtract(self.upper, self.lower))
        return np.array([self.centroid - half, self.centroid + half])

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] and triangles (k, 3): rectangles of sides up to ``edge`` [m], cut in four from the centre."""
        nodes, facets = box_surface(np.array(self.lower), np.array(self.upper), edge)
        return ((self._turned(nodes), facets),)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """The tiling, shifted by ``offset`` (fractions of a cell), where the box is aligned with the axes, else cut cells."""
        if any(self.angles):
            return super().lattice(size, offset)
        return tiling(self.lower, self.upper, size, offset)

    def fitted(self, size: float) -> Layout:
        """The tiling, turned with the box."""
        cells = tiling(self.lower, self.upper, size, (0.0, 0.0, 0.0))
        if not any(self.angles):
            return cells
        turn = turning(self.angles)
        return replace(cells, position=self._turned(cells.position), half_edges=turn @ cells.half_edges)

    def _turned(self, points: FloatArray) -> FloatArray:
        """Points (n, 3) [m] turned about the centre."""
        if not any(self.angles):
            return points
        turned: FloatArray = self.centroid + (points - self.centroid) @ turning(self.angles).T
        return turned
