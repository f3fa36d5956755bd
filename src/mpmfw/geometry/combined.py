"""Unions and differences of shapes, in the plane by shapely, in space by manifold3d."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import shapely
from pydantic import Field, model_validator

from mpmfw.geometry.base import BodyGeometry
from mpmfw.geometry.cut_cells import volume_of
from mpmfw.geometry.disc import Disc, Ring
from mpmfw.geometry.extrusion import Cylinder, Extrusion, Revolution, Torus
from mpmfw.geometry.layout import FloatArray, IntArray, Layout, layout_of_quadrilaterals
from mpmfw.geometry.plane import PlaneGeometry, Polygon, Rectangle, loops_of, number_of_segments, polygon_mesh
from mpmfw.geometry.solid import Ball, Box, SolidGeometry, Surfaces, joined
from mpmfw.geometry.surface_checks import shells_of
from mpmfw.geometry.surface_mesh import divided_shells

#: Turn of an outline [rad] from which a node is a corner: circles are polygons of 4 096 nodes.
CORNER = 0.01
#: Distance by which nodes that nearly coincide may be moved together, over the edge of the triangles.
NEAR = 0.01


class Region(PlaneGeometry):
    """Any region of the plane: ``whole`` is a shapely polygon or several [m]."""

    type: Literal["region"] = "region"
    whole: Any

    @property
    def region(self) -> Any:
        return self.whole

    @property
    def polygons(self) -> tuple[Any, ...]:
        """The pieces, shapely polygons."""
        return tuple(shapely.get_parts(self.whole))

    @property
    def is_connected(self) -> bool:
        return len(self.polygons) == 1

    @property
    def has_volume(self) -> bool:
        """Return True if the region has an area."""
        return bool(self.whole.area > 0.0)

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """Polylines with the corners among their nodes, arcs in equal segments."""
        return tuple(resampled(loop, segment) for polygon in self.polygons for loop in loops_of(polygon))

    def surface_nodes(self, edge: float) -> float:
        """Most nodes with segments up to ``edge`` [m]."""
        corners = sum(len(outline) for outline in self.outlines(self.outline_length))
        return 2.0 * self.outline_length / edge + corners + 8.0

    def fitted(self, size: float) -> Layout:
        """Quadrilaterals by gmsh, between straight segments where the outline is curved."""
        pieces = [Region(whole=polygon).outlines(size) for polygon in self.polygons]
        return layout_of_quadrilaterals(np.concatenate([polygon_mesh(loops, size) for loops in pieces]))


def resampled(loop: FloatArray, segment: float) -> FloatArray:
    """Return a closed polyline (m, 2) [m]: corners kept, what lies between in segments up to ``segment``."""
    before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    turn = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1))
    corners = np.flatnonzero(np.abs(turn) > CORNER)
    first = corners[0] if len(corners) else 0
    closed = np.roll(loop, -first, axis=0)[[*range(len(loop)), 0]]
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1)))
    ends = along[[*(corners - first), len(loop)]] if len(corners) else along[[0, -1]]
    counts = [number_of_segments(length, segment) for length in np.diff(ends)]
    places = np.concatenate(
        [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(ends, ends[1:], counts, strict=False)]
    )
    return np.column_stack([np.interp(places, along, closed[:, axis]) for axis in range(2)])


class Solid(SolidGeometry):
    """The union of parts in space, or the first less the others."""

    type: Literal["solid"] = "solid"
    parts: tuple[Any, ...]
    subtracts: bool

    @property
    def has_volume(self) -> bool:
        """Return True if the body has a volume."""
        corners = np.array([part.bounds for part in self.parts])
        return len(self._combined(float(np.ptp(corners)))[0]) > 0

    @cached_property
    def fine_surface(self) -> tuple[FloatArray, IntArray]:
        corners = np.array([part.bounds for part in self.parts])
        return self._combined(float(np.ptp(corners, axis=(0, 1)).max()) / 60.0)

    @property
    def bounds(self) -> FloatArray:
        nodes, _ = self.fine_surface
        return np.array([nodes.min(axis=0), nodes.max(axis=0)])

    @property
    def is_connected(self) -> bool:
        pieces = [volume_of(*surface) > 0.0 for surface in self.surfaces(float(np.ptp(self.bounds)))]
        return sum(pieces) == 1  # other surfaces are those of cavities

    def surface_nodes(self, edge: float) -> float:
        return float(2.0 * sum(part.surface_nodes(edge) for part in self.parts))

    def surfaces(self, edge: float) -> Surfaces:
        nodes, facets = self._combined(edge, NEAR * edge)
        return divided_shells(nodes, facets, shells_of(facets, len(nodes)), edge)

    def _combined(self, edge: float, near: float = 0.0) -> tuple[FloatArray, IntArray]:
        try:
            from manifold3d import Manifold, Mesh64
        except ImportError as error:
            raise ValueError(
                "unions and differences in space need manifold3d: pip install 'mpmfw[mesh]'"
            ) from error
        surfaces = [joined(part.surfaces(edge)) for part in self.parts]
        whole, *others = [Manifold(Mesh64(nodes, facets.astype(np.uint64))) for nodes, facets in surfaces]
        for other in others:
            whole = whole - other if self.subtracts else whole + other
        mesh = whole.simplify(near).to_mesh64()
        return np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts, dtype=np.int64)


def _of_whole(name: str) -> Any:
    """Return a property of this name, or a method, as that of the combined shape."""
    return property(lambda combined: getattr(combined.whole, name))


class Combined(BodyGeometry):
    """Base of unions and differences of ``parts``, all in the plane or all in space."""

    subtracts: ClassVar[bool] = False
    parts: tuple[Any, ...]

    @property
    def dim(self) -> int:  # type: ignore[override]
        return int(self.parts[0].dim)

    @cached_property
    def whole(self) -> Region | Solid:
        """The combined shape."""
        parts: list[Any] = [part.whole if isinstance(part, Combined) else part for part in self.parts]
        if self.dim == 3:
            return Solid(parts=tuple(parts), subtracts=self.subtracts)
        first, *others = [part.region for part in parts]
        other = shapely.union_all(others)
        return Region(whole=first - other if self.subtracts else first | other)

    @model_validator(mode="after")
    def _leaves_something(self) -> Self:
        if len({part.dim for part in self.parts}) > 1:
            raise ValueError("some parts are in the plane and some in space; expected one of both")
        if not self.whole.has_volume:
            raise ValueError("nothing is left of the first part; expected others that leave some of it")
        return self

    exact_volume: ClassVar[Any] = _of_whole("exact_volume")
    centroid: ClassVar[Any] = _of_whole("centroid")
    bounds: ClassVar[Any] = _of_whole("bounds")
    width: ClassVar[Any] = _of_whole("width")
    is_connected: ClassVar[Any] = _of_whole("is_connected")
    surface_nodes: ClassVar[Any] = _of_whole("surface_nodes")
    surfaces: ClassVar[Any] = _of_whole("surfaces")
    lattice: ClassVar[Any] = _of_whole("lattice")
    fitted: ClassVar[Any] = _of_whole("fitted")


_SHAPES = Disc | Ring | Rectangle | Polygon | Box | Ball | Cylinder | Torus | Extrusion | Revolution


class Union(Combined):
    """All that lies in one of the ``parts``."""

    type: Literal["union"] = "union"
    parts: Annotated[tuple[Annotated[_SHAPES, Field(discriminator="type")], ...], Field(min_length=2)]


class Difference(Combined):
    """The first of the ``parts`` without the others."""

    subtracts: ClassVar[bool] = True
    type: Literal["difference"] = "difference"
    parts: Annotated[tuple[Annotated[_SHAPES | Union, Field(discriminator="type")], ...], Field(min_length=2)]
