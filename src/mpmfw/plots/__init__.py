"""Figures of runs and comparisons, as matplotlib figures that touch no global state."""

from mpmfw.plots.costs import cost_bars
from mpmfw.plots.files import figures_of, plot_file
from mpmfw.plots.generic import gap_history, series_overview
from mpmfw.plots.rings import contact_force
from mpmfw.plots.rolling import motion, positions

__all__ = [
    "contact_force",
    "cost_bars",
    "figures_of",
    "gap_history",
    "motion",
    "plot_file",
    "positions",
    "series_overview",
]
