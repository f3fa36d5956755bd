"""The base class of shape functions, and what fills their tables."""

from __future__ import annotations

from mpmfw.geometry.layout import Layout
from mpmfw.plugin.base import ShapeFunction, check_inside, empty_stencil
from mpmfw.state.structs import OutsideGrid

__all__ = ["Layout", "OutsideGrid", "ShapeFunction", "check_inside", "empty_stencil"]
