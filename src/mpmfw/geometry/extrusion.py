"""Extrusion of a plane outline, and the cylinder."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from mpmfw.geometry.base import Point3D, PositiveLength
from mpmfw.geometry.disc import Disc
from mpmfw.geometry.layout import FloatArray
from mpmfw.geometry.polygon import Polygon
from mpmfw.geometry.rectangle import Rectangle
from mpmfw.geometry.ring import Ring
from mpmfw.geometry.solid import AxialSolid, Surfaces, TurnedSolid
from mpmfw.geometry.swept import extruded_surface
from mpmfw.units import Length

PlaneOutline = Annotated[Disc | Ring | Rectangle | Polygon, Field(discriminator="type")]


class Extrusion(TurnedSolid):
    """A plane shape moved along z from ``low`` to ``high`` [m], turned about its centroid by ``angles``
    [rad] about x, y, z.
    """

    type: Literal["extrusion"] = "extrusion"
    outline: PlaneOutline
    low: Length
    high: Length

    @model_validator(mode="after")
    def _low_below_high(self) -> Self:
        if not self.low < self.high:
            raise ValueError(f"low {self.low} m must be below high {self.high} m")
        return self

    @property
    def exact_volume(self) -> float:
        """Area of the outline times the length [m^3]."""
        return float(self.outline.exact_volume * (self.high - self.low))

    @property
    def centroid(self) -> FloatArray:
        """Centroid (3,) [m]."""
        return np.array([*self.outline.centroid, 0.5 * (self.low + self.high)])

    @property
    def area(self) -> float:
        """Of both ends and the sides [m^2]."""
        sides = self.outline.outline_length * (self.high - self.low)
        return float(2.0 * self.outline.exact_volume + sides)

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 3) [m]."""
        nodes = self.fine_nodes
        return np.array([nodes.min(axis=0), nodes.max(axis=0)])

    @property
    def fine_nodes(self) -> FloatArray:
        """Nodes (n, 3) [m] on the rims, so fine that they bound the body."""
        loops = np.concatenate(self.outline.outlines(self.outline.outline_length / 400.0))
        ends = [np.column_stack([loops, np.full(len(loops), z)]) for z in (self.low, self.high)]
        return self.turned(np.concatenate(ends))

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] and triangles (k, 3) of sides up to ``edge`` [m], across the sides up to 1.4 of
        it.
        """
        nodes, facets = extruded_surface(self.outline.outlines(edge), self.low, self.high, edge)
        return ((self.turned(nodes), facets),)


class Cylinder(AxialSolid):
    """A full cylinder [m], its ``length`` along ``axis``, turned about its centre by ``angles`` [rad]
    about x, then y, then z.
    """

    type: Literal["cylinder"] = "cylinder"
    centre: Point3D
    radius: PositiveLength
    length: PositiveLength

    @property
    def exact_volume(self) -> float:
        """π R² l [m^3]."""
        return float(np.pi * self.radius**2 * self.length)

    @property
    def centroid(self) -> FloatArray:
        """The centre (3,) [m]."""
        return np.array(self.centre)

    @property
    def area(self) -> float:
        """2 π R (R + l) [m^2]."""
        return float(2.0 * np.pi * self.radius * (self.radius + self.length))

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 3) [m]."""
        along = self.turn[:, 2]
        half = 0.5 * self.length * np.abs(along) + self.radius * np.sqrt(np.maximum(1.0 - along**2, 0.0))
        return np.array([self.centroid - half, self.centroid + half])

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] and triangles (k, 3) of sides up to ``edge`` [m], across the sides up to 1.4 of
        it.
        """
        disc = Disc(centre=(0.0, 0.0), radius=self.radius)
        nodes, facets = extruded_surface(disc.outlines(edge), -0.5 * self.length, 0.5 * self.length, edge)
        return ((self.centroid + nodes @ self.turn.T, facets),)
