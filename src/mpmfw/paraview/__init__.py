"""Results for ParaView: points and surfaces as VTK XML, series as a table."""

from mpmfw.paraview.exporting import export

__all__ = ["export"]
