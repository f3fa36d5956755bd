"""How far contact can be driven: one run judged by its invariants, and maps over stiffness and time step."""

from mpmfw.stability.chart import CLASSES, stability_map
from mpmfw.stability.outcome import Outcome, probe

__all__ = ["CLASSES", "Outcome", "probe", "stability_map"]
