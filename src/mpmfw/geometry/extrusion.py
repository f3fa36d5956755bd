"""Extrusions and revolutions of a plane outline, the cylinder and the torus among them.

Sides of the triangles of their surfaces are up to 1.4 of the requested edge."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from mpmfw.geometry.base import Centred, Point3D, PositiveLength
from mpmfw.geometry.disc import Disc, Ring
from mpmfw.geometry.layout import FloatArray
from mpmfw.geometry.polygon import Polygon, Rectangle
from mpmfw.geometry.solid import AxialSolid, Surfaces, TurnedSolid
from mpmfw.geometry.swept import extruded_surface, revolved_surface
from mpmfw.units import Length

PlaneOutline = Annotated[Disc | Ring | Rectangle | Polygon, Field(discriminator="type")]


class Extrusion(TurnedSolid):
    """A plane shape from z = ``low`` to ``high`` [m], turned about its centroid by ``angles`` [rad]."""

    type: Literal["extrusion"] = "extrusion"
    outline: PlaneOutline
    low: Length
    high: Length
    rising: ClassVar[tuple[str, str]] = ("low", "high")

    @property
    def exact_volume(self) -> float:
        return float(self.outline.exact_volume * (self.high - self.low))

    @property
    def centroid(self) -> FloatArray:
        return np.array([*self.outline.centroid, 0.5 * (self.low + self.high)])

    @property
    def area(self) -> float:
        sides = self.outline.outline_length * (self.high - self.low)
        return float(2.0 * self.outline.exact_volume + sides)

    @property
    def bounds(self) -> FloatArray:
        loops = np.concatenate(self.outline.outlines(self.outline.outline_length / 400.0))
        ends = [np.column_stack([loops, np.full(len(loops), z)]) for z in (self.low, self.high)]
        nodes = self.turned(np.concatenate(ends))
        return np.array([nodes.min(axis=0), nodes.max(axis=0)])

    def surfaces(self, edge: float) -> Surfaces:
        nodes, facets = extruded_surface(self.outline.outlines(edge), self.low, self.high, edge)
        return ((self.turned(nodes), facets),)


class Cylinder(Centred, AxialSolid):
    """A full cylinder [m] along ``axis``, turned about its centre by ``angles`` [rad]."""

    type: Literal["cylinder"] = "cylinder"
    centre: Point3D
    radius: PositiveLength
    length: PositiveLength

    @property
    def exact_volume(self) -> float:
        return float(np.pi * self.radius**2 * self.length)

    @property
    def area(self) -> float:
        return float(2.0 * np.pi * self.radius * (self.radius + self.length))

    @property
    def bounds(self) -> FloatArray:
        along = self.turn[:, 2]
        half = 0.5 * self.length * np.abs(along) + self.radius * np.sqrt(np.maximum(1.0 - along**2, 0.0))
        return np.array([self.centroid - half, self.centroid + half])

    def surfaces(self, edge: float) -> Surfaces:
        disc = Disc(centre=(0.0, 0.0), radius=self.radius)
        nodes, facets = extruded_surface(disc.outlines(edge), -0.5 * self.length, 0.5 * self.length, edge)
        return ((self.centroid + nodes @ self.turn.T, facets),)


#: Nodes so near to the axis lie on it, over the outline's extent.
ON_AXIS = 1e-9


class Revolution(AxialSolid):
    """A plane shape that goes round ``axis``: distance from it and height above ``origin`` [m].

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
                "distance from the axis, of 0 or more"
            )
        return self

    @property
    def exact_volume(self) -> float:
        """2 π r A of the outline's area A and its centroid's distance r (Pappus) [m^3]."""
        return float(2.0 * np.pi * self.outline.centroid[0] * self.outline.exact_volume)

    @property
    def bounds(self) -> FloatArray:
        nodes = np.concatenate(self.outline.outlines(self.outline.outline_length / 400.0))
        radius, height = nodes[:, :1], nodes[:, 1:]
        along = self.turn[:, 2]
        across = np.sqrt(np.maximum(1.0 - along**2, 0.0))
        middle = np.array(self.origin) + height * along
        lower, upper = (middle - radius * across).min(axis=0), (middle + radius * across).max(axis=0)
        return np.array([lower, upper])

    def surfaces(self, edge: float) -> Surfaces:
        found = []
        for loop in self.outline.outlines(edge):
            near = np.abs(loop[:, :1]) < ON_AXIS * np.ptp(loop)
            nodes, facets = revolved_surface(np.where(near & (np.arange(2) == 0), 0.0, loop), edge)
            found.append((np.array(self.origin) + nodes @ self.turn.T, facets))
        return tuple(found)


class Torus(Centred, AxialSolid):
    """A torus [m]: a disc of ``tube_radius`` whose centre runs round ``axis`` on a circle of ``radius``.

    The body is turned about its centre by ``angles`` [rad] about x, then y, then z.
    """

    type: Literal["torus"] = "torus"
    centre: Point3D
    radius: PositiveLength
    tube_radius: PositiveLength
    rising: ClassVar[tuple[str, str]] = ("tube_radius", "radius")

    @property
    def exact_volume(self) -> float:
        return float(2.0 * np.pi**2 * self.radius * self.tube_radius**2)

    @property
    def width(self) -> float:
        return float(2.0 * self.tube_radius)

    @property
    def area(self) -> float:
        return float(4.0 * np.pi**2 * self.radius * self.tube_radius)

    @property
    def bounds(self) -> FloatArray:
        return self._revolution.bounds

    def surfaces(self, edge: float) -> Surfaces:
        return self._revolution.surfaces(edge)

    @property
    def _revolution(self) -> Revolution:
        tube = Disc(centre=(self.radius, 0.0), radius=self.tube_radius)
        return Revolution(outline=tube, origin=self.centre, axis=self.axis, angles=self.angles)
