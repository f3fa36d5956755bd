"""Figures of runs, comparisons and studies, as matplotlib figures that touch no global state."""

from mpmfw.plots.costs import cost_bars
from mpmfw.plots.files import figures_of, plot_file, plot_files
from mpmfw.plots.generic import gap_history, series_overview
from mpmfw.plots.rings import contact_force
from mpmfw.plots.rolling import deviation, motion, positions
from mpmfw.plots.study import front, stages

__all__ = [
    "contact_force",
    "cost_bars",
    "deviation",
    "figures_of",
    "front",
    "gap_history",
    "motion",
    "plot_file",
    "plot_files",
    "positions",
    "series_overview",
    "stages",
]
