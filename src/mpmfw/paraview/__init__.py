"""Results for ParaView: material points and surfaces of every output as VTK XML, the series as a table."""

from mpmfw.paraview.exporting import export

__all__ = ["export"]
