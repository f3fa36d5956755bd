"""Ball."""

from __future__ import annotations

from typing import Literal

import numpy as np

from mpmfw.geometry.layout import FloatArray
from mpmfw.geometry.plane import Point3D, PositiveLength
from mpmfw.geometry.solid import SolidGeometry, Surfaces
from mpmfw.geometry.triangles import sphere_surface


class Ball(SolidGeometry):
    """A full sphere [m]."""

    type: Literal["ball"] = "ball"
    centre: Point3D
    radius: PositiveLength

    @property
    def exact_volume(self) -> float:
        """4 π R³/3 [m^3]."""
        return float(4 / 3 * np.pi * self.radius**3)

    @property
    def width(self) -> float:
        """2 R [m]."""
        return float(2.0 * self.radius)

    @property
    def centroid(self) -> FloatArray:
        """The centre (3,) [m]."""
        return np.array(self.centre)

    @property
    def area(self) -> float:
        """4 π R² [m^2]."""
        return float(4 * np.pi * self.radius**2)

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 3) [m]."""
        return np.add(self.centre, [[-self.radius], [self.radius]])

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] on the sphere and triangles (k, 3) of edges up to ``edge`` [m]."""
        return (sphere_surface(self.centroid, self.radius, edge),)
