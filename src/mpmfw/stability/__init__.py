"""How far contact can be driven: one run judged by its invariants, and maps over stiffness and time step."""

from mpmfw.stability.chart import CLASSES, stability_map
from mpmfw.stability.invariants import Invariants, probe

__all__ = ["CLASSES", "Invariants", "probe", "stability_map"]
