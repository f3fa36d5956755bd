"""Base classes of plug-ins that a scene names as often as it likes: loads, boundary conditions and
outputs.
"""

from __future__ import annotations

from mpmfw.plugin.base import NamedPlugIn, OutputSeries
from mpmfw.plugin.load import BodyLoad, Boundary, Load, LoadedFacets, SurfaceLoad, shares_near

__all__ = [
    "BodyLoad",
    "Boundary",
    "Load",
    "LoadedFacets",
    "NamedPlugIn",
    "OutputSeries",
    "SurfaceLoad",
    "shares_near",
]
