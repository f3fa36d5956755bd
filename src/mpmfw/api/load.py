"""Base classes of plug-ins that a scene names as often as it likes: loads, boundary conditions and
outputs.
"""

from __future__ import annotations

from mpmfw.plugin.boundary import Boundary
from mpmfw.plugin.load import BodyLoad, Load, LoadedFacets, SurfaceLoad
from mpmfw.plugin.named import NamedPlugIn, OutputSeries, shares_near

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
