"""From a geometry to the material points and the outline of a body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapSerializer,
    WrapValidator,
    model_validator,
)

from mpmfw.errors import SceneError
from mpmfw.geometry.base import BodyGeometry, LengthInCells
from mpmfw.geometry.combined import Difference, Union
from mpmfw.geometry.disc import Disc, Ring
from mpmfw.geometry.extrusion import Cylinder, Extrusion, Revolution, Torus
from mpmfw.geometry.half_space import HalfSpace
from mpmfw.geometry.layout import Layout, layout_of_boxes
from mpmfw.geometry.mesh_file import MeshFile
from mpmfw.geometry.plane import Polygon, Rectangle
from mpmfw.geometry.solid import Ball, Box
from mpmfw.geometry.surface_mesh import SurfaceMesh
from mpmfw.plugin.discovery import available, load, only_bundled

Fraction = Annotated[float, Field(ge=0.0, lt=1.0, allow_inf_nan=False)]


class Particles(BaseModel):
    """How a body is divided into material points.

    ``lattice`` has square cells clipped by the outline, ``fitted`` quadrilaterals that follow it. ``size`` is
    the largest edge of a domain [m]; merged pieces and the outer cells of a fitted ring are slightly larger,
    and a fitted mesh file keeps its elements. ``offset`` shifts the lattice, in fractions of a cell.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    layout: Literal["lattice", "fitted"] = "lattice"
    size: LengthInCells
    offset: tuple[Fraction, ...] = Field(default=(), max_length=3)

    @model_validator(mode="after")
    def _offset_needs_a_lattice(self) -> Self:
        if self.layout == "fitted" and any(self.offset):
            raise ValueError(
                "offset shifts a lattice; a fitted layout follows the outline and has none to shift"
            )
        return self

    def offset_in(self, dim: int) -> tuple[float, ...]:
        """Return the offset as ``dim`` fractions; a ValueError if more are given."""
        if len(self.offset) > dim:
            raise ValueError(f"offset has {len(self.offset)} entries for a body in {dim}D")
        return self.offset + (0.0,) * (dim - len(self.offset))


def geometry_class(name: str) -> type[BodyGeometry]:
    """Return the announced geometry of this name, or ``module:Class``; a SceneError if it is none."""
    plugin = load("geometry", name)
    refuse_incomplete(plugin)
    return plugin


def refuse_incomplete(plugin: type[Any]) -> None:
    """Refuse a class that is not a geometry, or lacks an attribute of geometries."""
    named = f"geometry {plugin.__module__}.{plugin.__qualname__}"
    if not issubclass(plugin, BodyGeometry):
        raise SceneError(
            f"{named}: expected a class derived from mpmfw.api.PlaneGeometry or mpmfw.api.SolidGeometry"
        )
    if missing := sorted(getattr(plugin, "__abstractmethods__", ())):
        raise SceneError(f"{named} lacks {', '.join(missing)}; expected all that its base class leaves open")


def _of_any_distribution(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
    """A geometry of another distribution by its own model, a bundled one by the union of these."""
    if isinstance(value, BodyGeometry):
        return value
    name = value.get("type") if isinstance(value, Mapping) else None
    if not isinstance(name, str) or only_bundled("geometry", name) or name not in available("geometry"):
        return handler(value)
    try:
        plugin = geometry_class(name)
        return plugin.model_validate({**value, "type": plugin.name})
    except ValidationError:
        raise
    except Exception as error:  # a stranger's validators may raise anything
        said = (
            str(error)
            if isinstance(error, SceneError)
            else f"geometry '{name}': {type(error).__name__}: {error}"
        )
        raise ValueError(said) from error


Geometry = Annotated[
    Disc
    | Ring
    | Rectangle
    | Polygon
    | MeshFile
    | Box
    | Ball
    | Cylinder
    | Torus
    | Extrusion
    | Revolution
    | SurfaceMesh
    | HalfSpace
    | Union
    | Difference,
    Field(discriminator="type"),
    WrapValidator(_of_any_distribution),
    WrapSerializer(lambda one, handler: one.model_dump() if isinstance(one, BodyGeometry) else handler(one)),
]


def discretise(geometry: Geometry, particles: Particles | None, segment: float | None) -> Layout:
    """Divide a body into material points, and its surface into facets.

    Sides of facets are at most ``segment`` [m] long; without it there are none, as no points without
    ``particles``. A ValueError refuses a layout that the geometry lacks, and a segment that is not positive.
    """
    if segment is not None and segment <= 0:
        raise ValueError(f"the segment length must be positive, not {segment} m")
    if particles is None:
        layout = layout_of_boxes(np.zeros((0, geometry.dim)), np.zeros((0, geometry.dim)))
    elif particles.layout == "fitted":
        layout = geometry.fitted(particles.size)
    else:
        layout = geometry.lattice(particles.size, particles.offset_in(geometry.dim))
    if segment is None:
        return layout
    surfaces = geometry.surfaces(segment)
    return replace(
        layout, outlines=tuple(nodes for nodes, _ in surfaces), facets=tuple(facets for _, facets in surfaces)
    )
