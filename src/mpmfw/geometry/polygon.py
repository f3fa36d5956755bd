"""Polygon."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Any, Literal, Self

import numpy as np
import shapely
from pydantic import Field, model_validator

from mpmfw.geometry.layout import FloatArray, Layout, layout_of_quadrilaterals
from mpmfw.geometry.plane import PlaneGeometry, Point2D
from mpmfw.geometry.polygon_mesh import polygon_mesh
from mpmfw.geometry.polylines import loops_of, subdivided

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

    @property
    def exact_volume(self) -> float:
        """Area [m^2], holes taken out."""
        return float(self.region.area)

    @property
    def centroid(self) -> FloatArray:
        """Centroid (2,) [m]."""
        return np.array(self.region.centroid.coords[0])

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """The outer polyline and one a hole, with the corners among their nodes."""
        return tuple(subdivided(loop, segment) for loop in loops_of(self.region))

    def fitted(self, size: float) -> Layout:
        """Quadrilaterals made by gmsh."""
        return layout_of_quadrilaterals(polygon_mesh(loops_of(self.region), size))
