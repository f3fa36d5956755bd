"""The base class of shape functions, and what fills their tables."""

from __future__ import annotations

from mpmfw.errors import OutsideGrid
from mpmfw.geometry.layout import Layout
from mpmfw.plugin.base import ShapeFunction, check_inside, empty_stencil

__all__ = ["Layout", "OutsideGrid", "ShapeFunction", "check_inside", "empty_stencil"]
