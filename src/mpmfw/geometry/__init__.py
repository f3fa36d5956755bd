"""Body outlines and particle layouts."""

from mpmfw.geometry.ball import Ball
from mpmfw.geometry.box import Box
from mpmfw.geometry.disc import Disc
from mpmfw.geometry.discretise import Geometry, discretise
from mpmfw.geometry.layout import FloatArray, Layout
from mpmfw.geometry.mesh_file import MeshFile
from mpmfw.geometry.particles import Particles
from mpmfw.geometry.polygon import Polygon
from mpmfw.geometry.rectangle import Rectangle
from mpmfw.geometry.ring import Ring

__all__ = [
    "Ball",
    "Box",
    "Disc",
    "FloatArray",
    "Geometry",
    "Layout",
    "MeshFile",
    "Particles",
    "Polygon",
    "Rectangle",
    "Ring",
    "discretise",
]
