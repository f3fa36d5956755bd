"""Disc."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import shapely

from mpmfw.geometry.disc_mesh import disc_mesh
from mpmfw.geometry.layout import FloatArray, Layout, layout_of_quadrilaterals
from mpmfw.geometry.plane import PlaneGeometry, Point2D, PositiveLength
from mpmfw.geometry.polylines import circle_outline, clipping_circle


class Disc(PlaneGeometry):
    """A full circle [m]."""

    type: Literal["disc"] = "disc"
    centre: Point2D
    radius: PositiveLength

    @property
    def exact_volume(self) -> float:
        """π R² [m^2]."""
        return float(np.pi * self.radius**2)

    @property
    def outline_length(self) -> float:
        """2 π R [m]."""
        return float(2.0 * np.pi * self.radius)

    @property
    def width(self) -> float:
        """2 R [m]."""
        return float(2.0 * self.radius)

    @property
    def centroid(self) -> FloatArray:
        """The centre (2,) [m]."""
        return np.array(self.centre)

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 2) [m]."""
        return np.add(self.centre, [[-self.radius], [self.radius]])

    @property
    def region(self) -> Any:
        """A fine polygon of the disc's area."""
        return shapely.Polygon(clipping_circle(self.centre, self.radius))

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """One polyline with its nodes on the circle, the first at angle 0.

        Their number is a multiple of four, so that the outline is symmetric about axes and diagonals.
        """
        return (circle_outline(self.centre, self.radius, segment),)

    def fitted(self, size: float) -> Layout:
        """A central block and four blocks around it, of the exact area."""
        return layout_of_quadrilaterals(np.array(self.centre) + self.radius * disc_mesh(size / self.radius))
