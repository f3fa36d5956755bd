"""Ball and box."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np

from mpmfw.geometry.base import Cornered, Point3D, Round
from mpmfw.geometry.clipped_lattice import tiling
from mpmfw.geometry.layout import FloatArray, Layout
from mpmfw.geometry.solid import SolidGeometry, Surfaces, TurnedSolid, turning
from mpmfw.geometry.triangles import box_surface, sphere_surface


class Ball(Round, SolidGeometry):
    """A full sphere [m]."""

    type: Literal["ball"] = "ball"
    centre: Point3D

    @property
    def exact_volume(self) -> float:
        """4 π R³/3 [m^3]."""
        return float(4 / 3 * np.pi * self.radius**3)

    @property
    def area(self) -> float:
        """4 π R² [m^2]."""
        return float(4 * np.pi * self.radius**2)

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] on the sphere and triangles (k, 3) of edges up to ``edge`` [m]."""
        return (sphere_surface(self.centroid, self.radius, edge),)


class Box(Cornered, TurnedSolid):
    """A cuboid between two corners [m], turned about its centre by ``angles`` [rad] about x, then y, then
    z.
    """

    has_plane_faces: ClassVar[bool] = True

    type: Literal["box"] = "box"
    lower: Point3D
    upper: Point3D

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 3) [m]."""
        if not any(self.angles):
            return np.array([self.lower, self.upper])
        half = np.abs(turning(self.angles)) @ (0.5 * np.subtract(self.upper, self.lower))
        return np.array([self.centroid - half, self.centroid + half])

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] and triangles (k, 3): rectangles of sides up to ``edge`` [m], cut in four from
        the centre.
        """
        nodes, facets = box_surface(np.array(self.lower), np.array(self.upper), edge)
        return ((self.turned(nodes), facets),)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """The tiling, shifted by ``offset`` (fractions of a cell), or cut cells where the box is turned."""
        if any(self.angles):
            return super().lattice(size, offset)
        return tiling(self.lower, self.upper, size, offset)

    def fitted(self, size: float) -> Layout:
        """The tiling, turned with the box."""
        cells = tiling(self.lower, self.upper, size, (0.0, 0.0, 0.0))
        if not any(self.angles):
            return cells
        half_edges = turning(self.angles) @ cells.half_edges
        return replace(cells, position=self.turned(cells.position), half_edges=half_edges)
