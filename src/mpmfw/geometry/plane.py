"""Bodies of the plane: their base, rectangle and polygon."""

from __future__ import annotations

import math
from abc import abstractmethod
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import shapely
from pydantic import Field, model_validator

from mpmfw.geometry.base import BodyGeometry, Cornered, Point2D
from mpmfw.geometry.clipped_lattice import clipped_lattice, tiling
from mpmfw.geometry.gmsh_file import blocks_of, started_gmsh
from mpmfw.geometry.layout import FloatArray, IntArray, Layout, layout_of_quadrilaterals
from mpmfw.units import Angle


class PlaneGeometry(BodyGeometry):
    """Base of plane bodies: subclasses give their :attr:`region` and :meth:`outlines`.

    Where the true shape is curved they give its :attr:`exact_volume`, :attr:`centroid` and :attr:`bounds`.
    """

    dim: ClassVar[int] = 2  #: number of space dimensions

    @property
    @abstractmethod
    def region(self) -> Any:
        """The body as a shapely polygon [m], of the exact area."""

    @property
    def exact_volume(self) -> float:
        return float(self.region.area)

    @property
    def centroid(self) -> FloatArray:
        return np.asarray(shapely.get_coordinates(self.region.centroid)[0])

    @property
    def outline_length(self) -> float:
        """Length of all outlines [m]."""
        return float(self.region.length)

    @cached_property
    def bounds(self) -> FloatArray:
        return np.reshape(self.region.bounds, (2, 2))

    @property
    def width(self) -> float:
        """Short side of the least rectangle round the body, however it is turned [m]."""
        corners = shapely.get_coordinates(shapely.oriented_envelope(self.region))
        return float(np.linalg.norm(np.diff(corners, axis=0), axis=1).min())

    @abstractmethod
    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """Closed polylines (m, 2) [m] on the true outline, with segments no longer than ``segment`` [m]."""

    def surfaces(self, edge: float) -> tuple[tuple[FloatArray, IntArray], ...]:
        """Nodes (m, 2) [m] and segments (m, 2) of every outline, the segments no longer than ``edge`` [m]."""
        loops = [(loop, np.arange(len(loop))) for loop in self.outlines(edge)]
        return tuple((loop, np.stack([node, np.roll(node, -1)], axis=1)) for loop, node in loops)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        return clipped_lattice(self.region, size, offset)


# Nodes of the polygon by which discs and rings are clipped: it departs from the circle by 4e-7 of the radius
CLIPPING_NODES = 4096


def number_of_segments(length: float, segment: float) -> int:
    """Least number of equal segments of at most ``segment`` [m] in ``length`` [m], deaf to round-off."""
    return max(1, math.ceil(length / segment - 1e-9))


def circle_nodes(centre: tuple[float, float], radius: float, n: int) -> FloatArray:
    """``n`` nodes (n, 2) [m] on a circle, counter-clockwise, the first at angle 0."""
    angle = 2 * np.pi * np.arange(n) / n
    return np.asarray(np.array(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)]))


def circle_outline(centre: tuple[float, float], radius: float, segment: float) -> FloatArray:
    """Nodes (n, 2) [m] on the true circle, n = 4 ceil(2 π radius/(4 segment)): it keeps the mirror planes."""
    return circle_nodes(centre, radius, 4 * number_of_segments(0.5 * np.pi * radius, segment))


def equal_area_factor(n: int) -> float:
    """Radius of the regular n-gon of a circle's area over the circle's: sqrt(x/sin x), x = 2 π/n."""
    return math.sqrt((2 * np.pi / n) / math.sin(2 * np.pi / n))


def clipping_circle(centre: tuple[float, float], radius: float) -> FloatArray:
    """A fine polygon (n, 2) [m] with the exact area of the disc."""
    return circle_nodes(centre, radius * equal_area_factor(CLIPPING_NODES), CLIPPING_NODES)


def subdivided(corners: FloatArray, segment: float) -> FloatArray:
    """A closed polyline (m, 2) [m]: corners (k, 2) kept, edges in equal segments of at most ``segment``."""
    pieces = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        n = number_of_segments(float(np.hypot(*(end - start))), segment)
        pieces.append(start + (end - start) * (np.arange(n) / n)[:, np.newaxis])
    return np.concatenate(pieces)


def loops_of(region: Any) -> tuple[FloatArray, ...]:
    """Rings (k, 2) [m] of a shapely polygon: the outer one counter-clockwise, holes clockwise."""
    oriented = shapely.geometry.polygon.orient(region, 1.0)
    return tuple(shapely.get_coordinates(ring)[:-1] for ring in (oriented.exterior, *oriented.interiors))


class Rectangle(Cornered, PlaneGeometry):
    """A rectangle between two corners [m], turned by ``angle`` [rad] counter-clockwise about its centre."""

    type: Literal["rectangle"] = "rectangle"
    lower: Point2D
    upper: Point2D
    angle: Angle = 0.0

    @cached_property
    def axes(self) -> FloatArray:
        """Unit vectors along the edges, one a row (2, 2): sides turn with the rectangle."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, s], [-s, c]])

    @cached_property
    def corners(self) -> FloatArray:
        """The four corners (4, 2) [m], counter-clockwise."""
        (x0, y0), (x1, y1) = self.lower, self.upper
        return self._turned(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]))

    @cached_property
    def region(self) -> Any:
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
        cells = tiling(self.lower, self.upper, size, (0.0, 0.0))
        if self.angle == 0:
            return cells
        assert cells.corners is not None
        return layout_of_quadrilaterals(self._turned(cells.corners))

    def _turned(self, points: FloatArray) -> FloatArray:
        if self.angle == 0:
            return points
        return np.asarray(self.centroid + (points - self.centroid) @ self.axes)


#: Sizes that gmsh is asked for until no edge is too long.
ATTEMPTS = 10

Loop = Annotated[tuple[Point2D, ...], Field(min_length=3)]


class Polygon(PlaneGeometry):
    """A simple polygon [m], with holes or without; the points may run either way round."""

    type: Literal["polygon"] = "polygon"
    points: Loop
    holes: tuple[Loop, ...] = ()

    @model_validator(mode="after")
    def _is_simple(self) -> Self:
        for loop in (self.points, *self.holes):
            if len(set(loop)) < 3:
                raise ValueError(
                    f"a loop of the polygon has {len(set(loop))} different points, and 3 are the least"
                )
        if not self.region.is_valid:
            raise ValueError(f"the polygon is not simple: {shapely.is_valid_reason(self.region)}")
        if self.region.area <= 0:
            raise ValueError("the polygon has no area")
        return self

    @cached_property
    def region(self) -> Any:
        """The polygon as a shapely one, without repeated points."""
        return shapely.remove_repeated_points(shapely.Polygon(self.points, self.holes))

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """The outer polyline and one a hole, with the corners among their nodes."""
        return tuple(subdivided(loop, segment) for loop in loops_of(self.region))

    def fitted(self, size: float) -> Layout:
        return layout_of_quadrilaterals(polygon_mesh(loops_of(self.region), size))


def polygon_mesh(loops: tuple[FloatArray, ...], size: float) -> FloatArray:
    """Fill loops (k, 2) [m] with quadrilaterals (n, 4, 2) of edges up to ``size``; it needs gmsh."""
    with started_gmsh("a fitted layout of a polygon") as gmsh:
        # In units of the size, far from gmsh's absolute tolerances; the last subdivision halves edges
        scaled = tuple(loop / size for loop in loops)
        target = 2.0
        for _ in range(ATTEMPTS):
            corners = _mesh(gmsh, scaled, target)
            largest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
            if largest <= 1.0:
                return size * corners
            # gmsh takes a size as an average: request less until the largest edge fits
            target *= max(0.5, 0.98 / largest)
    raise ValueError(f"gmsh made no quadrilaterals with edges below {size} m: choose layout = 'lattice'")


def _mesh(gmsh: Any, loops: tuple[FloatArray, ...], target: float) -> FloatArray:
    """One attempt: quadrilaterals (n, 4, 2) of the region within ``loops``, counter-clockwise."""
    gmsh.model.add("polygon")
    try:
        geo = gmsh.model.geo
        curves = []
        for loop in loops:
            nodes = [geo.addPoint(x, y, 0.0, target) for x, y in loop]
            lines = [geo.addLine(a, b) for a, b in zip(nodes, nodes[1:] + nodes[:1], strict=True)]
            curves.append(geo.addCurveLoop(lines))
        geo.addPlaneSurface(curves)
        geo.synchronize()
        for option, value in (("RecombineAll", 1), ("SubdivisionAlgorithm", 1), ("MeshSizeMax", target)):
            gmsh.option.setNumber(f"Mesh.{option}", value)
        gmsh.model.mesh.generate(2)
        points, blocks = blocks_of(gmsh, {3: 4})
        return points[blocks[3], :2]
    finally:
        gmsh.model.remove()
