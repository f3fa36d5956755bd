"""Base classes of geometries."""

from __future__ import annotations

from mpmfw.geometry.base import BodyGeometry
from mpmfw.geometry.plane import PlaneGeometry
from mpmfw.geometry.solid import SolidGeometry

__all__ = ["BodyGeometry", "PlaneGeometry", "SolidGeometry"]
