"""Extrusions and revolutions of a plane outline, the cylinder and the torus among them.

Sides of the triangles of their surfaces are up to 1.4 of the requested edge."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
import shapely
from pydantic import Field, model_validator

from mpmfw.geometry.base import Centred, Point3D, PositiveLength
from mpmfw.geometry.disc import Disc, Ring
from mpmfw.geometry.layout import FloatArray, IntArray, triangle_areas
from mpmfw.geometry.plane import Polygon, Rectangle, number_of_segments
from mpmfw.geometry.solid import AxialSolid, Surfaces, TurnedSolid
from mpmfw.units import Length

#: Least distance of inner nodes from the outline, over the edge.
AWAY = 0.6


def plane_triangles(loops: tuple[FloatArray, ...], edge: float) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 2) [m] and counter-clockwise Delaunay triangles (k, 3) of a plane region.

    ``loops`` are closed polylines (m, 2) [m], the outer one counter-clockwise, holes clockwise; their nodes
    come first. The nodes inside form equilateral triangles of sides ``edge`` [m]. A ValueError refuses parts
    of the outline that are nearer to each other than their nodes along it.
    """
    from scipy.spatial import Delaunay

    region = shapely.Polygon(loops[0], loops[1:])
    outline = np.concatenate(loops)
    inner = _inner_nodes(region, edge)
    nodes = np.concatenate([outline, inner])
    middle = outline.mean(axis=0)
    triangles = Delaunay((nodes - middle) / edge).simplices.astype(np.int64)
    area = triangle_areas(nodes[triangles])
    triangles = np.where(area[:, np.newaxis] < 0.0, triangles[:, ::-1], triangles)
    centre = nodes[triangles].mean(axis=1)
    shapely.prepare(region)
    within = shapely.contains_xy(region, centre[:, 0], centre[:, 1])
    triangles = triangles[(np.abs(area) > 1e-9 * edge**2) & within]
    covered = float(triangle_areas(nodes[triangles]).sum())
    if abs(covered - region.area) > 1e-9 * region.area or not _has_outline(loops, triangles):
        raise ValueError(
            f"the outline cannot be filled with triangles of {edge:.3g} m: parts of it are nearer to each "
            "other than its nodes; expected a smaller segment of the body"
        )
    return nodes, triangles


def _inner_nodes(region: object, edge: float) -> FloatArray:
    """Nodes (n, 2) [m] of equilateral triangles, symmetric about the middle, off the outline."""
    inside = shapely.buffer(region, -AWAY * edge)
    if inside.is_empty:
        return np.empty((0, 2))
    lower, upper = np.reshape(shapely.bounds(region), (2, 2))
    rows = int((upper[1] - lower[1]) / edge) + 1
    columns = int((upper[0] - lower[0]) / edge) + 1
    i, j = np.meshgrid(np.arange(-columns, columns + 1), np.arange(-rows, rows + 1), indexing="ij")
    points = np.stack([i + 0.5 * (j % 2), np.sqrt(0.75) * j], axis=-1).reshape(-1, 2)
    points = 0.5 * (lower + upper) + edge * points
    shapely.prepare(inside)
    return np.asarray(points[shapely.contains_xy(inside, points[:, 0], points[:, 1])])


def _has_outline(loops: tuple[FloatArray, ...], triangles: IntArray) -> bool:
    """Return True if every segment of the loops is a side of one triangle, in its direction."""
    sides = np.concatenate([triangles[:, [a, (a + 1) % 3]] for a in range(3)])
    key = sides[:, 0] * (triangles.max() + 1) + sides[:, 1]
    first, wanted = 0, []
    for loop in loops:
        here = first + np.arange(len(loop))
        wanted.append(here * (triangles.max() + 1) + first + (np.arange(len(loop)) + 1) % len(loop))
        first += len(loop)
    return bool(np.isin(np.concatenate(wanted), key).all())


#: Fewest nodes on a ring round the axis.
FEWEST = 6


def extruded_surface(
    loops: tuple[FloatArray, ...], low: float, high: float, edge: float
) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 3) [m] and triangles (k, 3) of a prism along z from ``low`` to ``high`` [m].

    ``loops`` (m, 2) bound the base [m], the material on their left, with segments up to ``edge`` [m]."""
    plane, cap = plane_triangles(loops, edge)
    rim = sum(len(loop) for loop in loops)
    layers = number_of_segments(high - low, edge)
    inner = np.arange(1, layers) / layers
    heights = low + (high - low) * inner
    nodes = [np.column_stack([plane, np.full(len(plane), z)]) for z in (low, high)]
    nodes += [np.column_stack([plane[:rim], np.full(rim, z)]) for z in heights]
    # the first node of every ring: the base, the rings between, the top
    start = [0, *(2 * len(plane) + rim * np.arange(layers - 1)).tolist(), len(plane)]
    facets = [cap[:, ::-1], cap + len(plane)]
    first = 0
    for loop in loops:
        here = first + np.arange(len(loop))
        after = first + (np.arange(len(loop)) + 1) % len(loop)
        for below, above in pairwise(start):
            facets += [np.stack([below + here, below + after, above + after], axis=1)]
            facets += [np.stack([below + here, above + after, above + here], axis=1)]
        first += len(loop)
    return np.concatenate(nodes), np.concatenate(facets)


def revolved_surface(loop: FloatArray, edge: float) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 3) [m] and triangles (k, 3) of what a closed polyline encloses when it turns about z.

    ``loop`` (m, 2) has the distance from the axis, not negative, and the height [m], the material on the
    left. A segment on the axis sweeps nothing."""
    rings, nodes, total = [], [], 0
    on_axis = loop[:, 0] == 0.0
    idle = on_axis & np.roll(on_axis, 1) & np.roll(on_axis, -1)  # within a segment on the axis
    for radius, height in loop[~idle]:
        n = max(FEWEST, 4 * number_of_segments(0.5 * np.pi * radius, edge)) if radius > 0.0 else 1
        angle = 2.0 * np.pi * np.arange(n) / n
        rings.append((total, angle))
        ring = [radius * np.cos(angle), radius * np.sin(angle), np.full(len(angle), height)]
        nodes.append(np.stack(ring, axis=1))
        total += len(angle)
    facets = [_strip(one, other) for one, other in zip(rings, [*rings[1:], rings[0]], strict=True)]
    return np.concatenate(nodes), np.concatenate(facets)


def _strip(one: tuple[int, FloatArray], other: tuple[int, FloatArray]) -> IntArray:
    """Triangles (k, 3) between two rings, each given by its first node and its nodes' angles."""
    (start, angles), (begin, others) = one, other
    n, m = len(angles), len(others)
    if n == m == 1:
        return np.empty((0, 3), dtype=np.int64)
    steps = [(2.0 * np.arange(k) + 1.0) / k if k > 1 else np.empty(0) for k in (n, m)]
    order = np.argsort(np.concatenate(steps), kind="stable")
    on_first = order < len(steps[0])
    here: IntArray = np.cumsum(on_first) - on_first
    there: IntArray = np.cumsum(~on_first) - ~on_first
    third = np.where(on_first, start + (here + 1) % n, begin + (there + 1) % m)
    return np.stack([start + here % n, third, begin + there % m], axis=1).astype(np.int64)


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
