"""From a geometry to the material points and the outline of a body."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from pydantic import Field

from mpmfw.geometry.ball import Ball
from mpmfw.geometry.box import Box
from mpmfw.geometry.disc import Disc
from mpmfw.geometry.extrusion import Cylinder, Extrusion
from mpmfw.geometry.layout import Layout
from mpmfw.geometry.mesh_file import MeshFile
from mpmfw.geometry.particles import Particles
from mpmfw.geometry.polygon import Polygon
from mpmfw.geometry.rectangle import Rectangle
from mpmfw.geometry.revolution import Revolution, Torus
from mpmfw.geometry.ring import Ring
from mpmfw.geometry.surface_mesh import SurfaceMesh

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
    | SurfaceMesh,
    Field(discriminator="type"),
]


def discretise(geometry: Geometry, particles: Particles, segment: float | None) -> Layout:
    """Divide a body into material points, and its surface into facets.

    Parameters
    ----------
    geometry
        The true shape.
    particles
        Kind and size of the layout.
    segment
        Largest length of a surface segment [m], in 3D of the sides of its triangles; None where no surface is wanted.

    Raises
    ------
    ValueError
        The geometry has no such layout, or the segment is not positive.
    """
    if segment is not None and segment <= 0:
        raise ValueError(f"the segment length must be positive, not {segment} m")
    if particles.layout == "fitted":
        layout = geometry.fitted(particles.size)
    else:
        layout = geometry.lattice(particles.size, particles.offset_in(geometry.dim))
    if segment is None:
        return layout
    surfaces = geometry.surfaces(segment)
    return replace(
        layout, outlines=tuple(nodes for nodes, _ in surfaces), facets=tuple(facets for _, facets in surfaces)
    )
