"""Base classes of loads, boundary conditions and outputs, which a scene may name several times."""

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
