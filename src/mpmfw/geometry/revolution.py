"""Revolution of a plane outline, and the torus."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from mpmfw.geometry.base import Point3D, PositiveLength
from mpmfw.geometry.disc import Disc
from mpmfw.geometry.extrusion import PlaneOutline
from mpmfw.geometry.layout import FloatArray
from mpmfw.geometry.solid import AxialSolid, Surfaces
from mpmfw.geometry.swept import revolved_surface

#: Nodes so near to the axis lie on it, over the outline's extent.
ON_AXIS = 1e-9


class Revolution(AxialSolid):
    """A plane shape that goes round ``axis``; its coordinates [m] are the distance from the axis and the
    height above ``origin``.

    The body is turned about the origin by ``angles`` [rad] about x, then y, then z.
    """

    type: Literal["revolution"] = "revolution"
    outline: PlaneOutline
    origin: Point3D = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _beside_the_axis(self) -> Self:
        lowest, extent = self.outline.bounds[0, 0], float(np.ptp(self.outline.bounds))
        if lowest < -ON_AXIS * extent:
            raise ValueError(
                f"the outline reaches {-lowest:.4g} m beyond the axis; expected a first coordinate, the "
                "distance from the axis, "
                "of 0 or more"
            )
        return self

    @property
    def exact_volume(self) -> float:
        """2 π r A of the outline's area A and its centroid's distance r (Pappus) [m^3]."""
        return float(2.0 * np.pi * self.outline.centroid[0] * self.outline.exact_volume)

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 3) [m]."""
        nodes = np.concatenate(self.outline.outlines(self.outline.outline_length / 400.0))
        radius, height = nodes[:, :1], nodes[:, 1:]
        along = self.turn[:, 2]
        across = np.sqrt(np.maximum(1.0 - along**2, 0.0))
        origin = np.array(self.origin)
        return np.array(
            [
                (origin + height * along - radius * across).min(axis=0),
                (origin + height * along + radius * across).max(axis=0),
            ]
        )

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] and triangles (k, 3) of every closed surface: sides up to ``edge`` [m], across
        rings 1.4 of it.
        """
        found = []
        for loop in self.outline.outlines(edge):
            near = np.abs(loop[:, :1]) < ON_AXIS * np.ptp(loop)
            nodes, facets = revolved_surface(np.where(near & (np.arange(2) == 0), 0.0, loop), edge)
            found.append((np.array(self.origin) + nodes @ self.turn.T, facets))
        return tuple(found)


class Torus(AxialSolid):
    """A torus [m]: a disc of ``tube_radius`` whose centre runs round ``axis`` on a circle of ``radius``.

    The body is turned about its centre by ``angles`` [rad] about x, then y, then z.
    """

    type: Literal["torus"] = "torus"
    centre: Point3D
    radius: PositiveLength
    tube_radius: PositiveLength

    @model_validator(mode="after")
    def _has_a_hole(self) -> Self:
        if self.tube_radius >= self.radius:
            raise ValueError(f"tube_radius {self.tube_radius} m must be smaller than radius {self.radius} m")
        return self

    @property
    def exact_volume(self) -> float:
        """2 π² R r² [m^3]."""
        return float(2.0 * np.pi**2 * self.radius * self.tube_radius**2)

    @property
    def width(self) -> float:
        """2 r, of the tube [m]."""
        return float(2.0 * self.tube_radius)

    @property
    def centroid(self) -> FloatArray:
        """The centre (3,) [m]."""
        return np.array(self.centre)

    @property
    def area(self) -> float:
        """4 π² R r [m^2]."""
        return float(4.0 * np.pi**2 * self.radius * self.tube_radius)

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 3) [m]."""
        return self._revolution.bounds

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] and triangles (k, 3) of sides up to ``edge`` [m], across rings up to 1.4 of it."""
        return self._revolution.surfaces(edge)

    @property
    def _revolution(self) -> Revolution:
        tube = Disc(centre=(self.radius, 0.0), radius=self.tube_radius)
        return Revolution(outline=tube, origin=self.centre, axis=self.axis, angles=self.angles)
