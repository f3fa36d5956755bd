"""Rectangle."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import shapely

from mpmfw.geometry.base import Cornered, Point2D
from mpmfw.geometry.clipped_lattice import tiling
from mpmfw.geometry.layout import FloatArray, Layout, layout_of_quadrilaterals
from mpmfw.geometry.plane import PlaneGeometry
from mpmfw.geometry.polylines import subdivided
from mpmfw.units import Angle


class Rectangle(Cornered, PlaneGeometry):
    """A rectangle between two corners [m], turned by ``angle`` [rad] counter-clockwise about its centre."""

    type: Literal["rectangle"] = "rectangle"
    lower: Point2D
    upper: Point2D
    angle: Angle = 0.0

    @property
    def axes(self) -> FloatArray:
        """Unit vectors along the edges, one a row (2, 2): sides turn with the rectangle."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, s], [-s, c]])

    @property
    def corners(self) -> FloatArray:
        """The four corners (4, 2) [m], counter-clockwise."""
        (x0, y0), (x1, y1) = self.lower, self.upper
        return self._turned(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]))

    @property
    def region(self) -> Any:
        """The rectangle as a shapely polygon."""
        return shapely.Polygon(self.corners)

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """One polyline with the corners among its nodes."""
        return (subdivided(self.corners, segment),)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """The tiling where the rectangle is aligned with the axes, else clipped cells."""
        if self.angle == 0:
            return tiling(self.lower, self.upper, size, offset)
        return super().lattice(size, offset)

    def fitted(self, size: float) -> Layout:
        """The tiling, turned with the rectangle."""
        cells = tiling(self.lower, self.upper, size, (0.0, 0.0))
        if self.angle == 0:
            return cells
        assert cells.corners is not None
        return layout_of_quadrilaterals(self._turned(cells.corners))

    def _turned(self, points: FloatArray) -> FloatArray:
        """Points (..., 2) [m] turned by the angle about the centre."""
        if self.angle == 0:
            return points
        c, s = np.cos(self.angle), np.sin(self.angle)
        turned: FloatArray = self.centroid + (points - self.centroid) @ np.array([[c, s], [-s, c]])
        return turned
