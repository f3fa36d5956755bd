"""Body outlines and particle layouts."""

from mpmfw.geometry.base import BodyGeometry
from mpmfw.geometry.disc import Disc, Ring
from mpmfw.geometry.discretise import Geometry, Particles, discretise
from mpmfw.geometry.extrusion import Cylinder, Extrusion, Revolution, Torus
from mpmfw.geometry.half_space import HalfSpace
from mpmfw.geometry.layout import Layout
from mpmfw.geometry.mesh_file import MeshFile
from mpmfw.geometry.plane import PlaneGeometry, Polygon, Rectangle
from mpmfw.geometry.solid import Ball, Box, SolidGeometry
from mpmfw.geometry.surface_mesh import SurfaceMesh

__all__ = [
    "Ball",
    "BodyGeometry",
    "Box",
    "Cylinder",
    "Disc",
    "Extrusion",
    "Geometry",
    "HalfSpace",
    "Layout",
    "MeshFile",
    "Particles",
    "PlaneGeometry",
    "Polygon",
    "Rectangle",
    "Revolution",
    "Ring",
    "SolidGeometry",
    "SurfaceMesh",
    "Torus",
    "discretise",
]
