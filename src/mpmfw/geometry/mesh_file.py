"""Body given by a finite element mesh."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Self

import shapely
from pydantic import model_validator

from mpmfw.geometry.boundary import boundary_loops, is_connected
from mpmfw.geometry.elements import Elements, read_elements
from mpmfw.geometry.layout import FloatArray, Layout, layout_of_quadrilaterals
from mpmfw.geometry.plane import PlaneGeometry
from mpmfw.geometry.polylines import subdivided


class MeshFile(PlaneGeometry):
    """A gmsh file (.msh) of first-order triangles and quads in the x-y plane, coordinates in [m].

    The elements themselves are the shape: their boundary edges make the outlines.
    """

    type: Literal["mesh"] = "mesh"
    path: Path

    @model_validator(mode="after")
    def _makes_one_region(self) -> Self:
        try:
            area = float(self.region.area)
            if not self.loops or abs(area - self.exact_volume) > 1e-6 * self.exact_volume:
                raise ValueError(
                    f"elements overlap: they cover {area} m^2 and have {self.exact_volume} m^2 in all"
                )
        except ValueError as error:
            raise ValueError(
                str(error) if str(self.path) in str(error) else f"{self.path}: {error}"
            ) from error
        return self

    @cached_property
    def elements(self) -> Elements:
        """The elements, read once."""
        return read_elements(self.path)

    @cached_property
    def loops(self) -> tuple[FloatArray, ...]:
        """The boundary edges chained into closed loops (m, 2) [m], the material on their left."""
        return boundary_loops(self.elements)

    @cached_property
    def region(self) -> Any:
        """The union of the elements."""
        nodes = self.elements.nodes
        blocks = (self.elements.triangles, self.elements.quadrilaterals)
        return shapely.union_all(
            [p for block in blocks if len(block) for p in shapely.polygons(nodes[block])]
        )

    @property
    def exact_volume(self) -> float:
        """Area of the elements [m^2]."""
        return self.elements.area

    @property
    def centroid(self) -> FloatArray:
        """Centroid (2,) [m] of the elements."""
        return self.elements.centroid

    @property
    def is_connected(self) -> bool:
        """Whether all elements hang together by edges."""
        return is_connected(self.elements)

    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """The boundary loops, with the mesh's nodes among theirs."""
        return tuple(subdivided(loop, segment) for loop in self.loops)

    def fitted(self, size: float) -> Layout:  # noqa: ARG002
        """The elements as they are, whatever ``size``: quads, and three quadrilaterals a triangle."""
        return layout_of_quadrilaterals(self.elements.pieces)
