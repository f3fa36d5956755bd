"""The base class of materials."""

from __future__ import annotations

from mpmfw.plugin.base import Material

__all__ = ["Material"]
