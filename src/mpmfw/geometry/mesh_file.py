"""Body given by a finite element mesh: plane triangles and quadrilaterals of a gmsh file."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
import shapely
from pydantic import model_validator

from mpmfw.geometry.gmsh_file import read_blocks, refuse_not_finite
from mpmfw.geometry.layout import FloatArray, Layout, layout_of_quadrilaterals
from mpmfw.geometry.plane import PlaneGeometry, loops_of, subdivided

# gmsh's numbers of first-order triangles and quadrangles, and their nodes
KINDS = {2: 3, 3: 4}
#: Of the parallelogram of a corner over the square of the longest side: an element with less has no area.
FLAT = 1e-10


class MeshFile(PlaneGeometry):
    """A gmsh file (.msh) of first-order triangles and quads in the x-y plane [m]; they are the shape."""

    type: Literal["mesh"] = "mesh"
    path: Path

    @model_validator(mode="after")
    def _makes_one_region(self) -> Self:
        try:
            covered, area = float(self.region.area), self.exact_volume
            if abs(covered - area) > 1e-6 * area:
                raise ValueError(f"elements overlap: they cover {covered:g} of their {area:g} m^2")
        except ValueError as error:
            message = str(error)
            raise ValueError(message if str(self.path) in message else f"{self.path}: {message}") from error
        return self

    @cached_property
    def elements(self) -> tuple[FloatArray, FloatArray]:
        """Corners (k, 3, 2) [m] of triangles and (m, 4, 2) of quads, counter-clockwise, read once."""
        return read_elements(self.path)

    @cached_property
    def polygons(self) -> Any:
        """The elements as shapely polygons (n,)."""
        return np.concatenate([shapely.polygons(corners) for corners in self.elements])

    @cached_property
    def region(self) -> Any:
        """The union of the elements, a polygon for each connected part."""
        return shapely.union_all(self.polygons)

    @property
    def exact_volume(self) -> float:
        return float(shapely.area(self.polygons).sum())

    @property
    def centroid(self) -> FloatArray:
        area, centre = shapely.area(self.polygons), shapely.centroid(self.polygons)
        return np.asarray(area @ shapely.get_coordinates(centre) / area.sum())

    @property
    def is_connected(self) -> bool:
        return isinstance(self.region, shapely.Polygon)

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """The boundary of every part, with the mesh's nodes among its nodes."""
        parts = shapely.get_parts(self.region)
        return tuple(subdivided(loop, segment) for part in parts for loop in loops_of(part))

    def fitted(self, size: float) -> Layout:  # noqa: ARG002
        """The elements as they are, whatever ``size``: three quadrilaterals a triangle, and quads."""
        return layout_of_quadrilaterals(self.pieces)

    @property
    def pieces(self) -> FloatArray:
        """Quadrilaterals (3 k + m, 4, 2) [m]; those of a triangle meet at its centroid."""
        corner, quads = self.elements
        after = 0.5 * (corner + np.roll(corner, -1, axis=1))
        centroid = np.broadcast_to(corner.mean(axis=1, keepdims=True), corner.shape)
        thirds = np.stack([corner, after, centroid, np.roll(after, 1, axis=1)], axis=2).reshape(-1, 4, 2)
        return np.concatenate([thirds, quads])


def read_elements(path: Path) -> tuple[FloatArray, FloatArray]:
    """Read triangles (k, 3, 2) and quads (m, 4, 2) [m] of a gmsh file; a ValueError refuses others."""
    if not path.is_file():
        raise ValueError(f"mesh file not found: {path}")
    points, blocks = read_blocks(path, KINDS)
    refuse_not_finite(path, points)
    if len(points) and np.ptp(points[:, 2:]) > 1e-9 * np.ptp(points):
        raise ValueError(f"{path} is not in a plane z = constant")
    if not any(map(len, blocks.values())):
        raise ValueError(f"{path} has no triangles or quads")
    triangles, quads = (_counter_clockwise(points[blocks[kind], :2], path) for kind in KINDS)
    return triangles, quads


def _counter_clockwise(corner: FloatArray, path: Path) -> FloatArray:
    """Corners (n, k, 2) of elements turned counter-clockwise; refused where one is flat or reentrant."""
    ahead, behind = np.roll(corner, -1, axis=1) - corner, corner - np.roll(corner, 1, axis=1)
    turn = behind[..., 0] * ahead[..., 1] - behind[..., 1] * ahead[..., 0]
    least = FLAT * (ahead**2).sum(axis=2).max(axis=1, keepdims=True)
    convex = (turn > least).all(axis=1) | (turn < -least).all(axis=1)
    if not convex.all():
        first = corner[~convex][0].mean(axis=0)
        raise ValueError(
            f"{path} has {np.count_nonzero(~convex)} degenerate or non-convex elements, the first at "
            f"({first[0]:.4g}, {first[1]:.4g}) m"
        )
    return np.where(turn[:, :1, np.newaxis] > 0, corner, corner[:, ::-1])
