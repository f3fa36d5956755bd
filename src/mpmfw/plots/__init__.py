"""Figures of runs, comparisons and studies, for matplotlib."""

from mpmfw.plots.animation import animate
from mpmfw.plots.field_figure import field, side_by_side
from mpmfw.plots.files import figures_of, plot_file, write_figure
from mpmfw.plots.histories import history
from mpmfw.plots.scene import contact_force, gap_history, motion, positions
from mpmfw.plots.study import cost_bars, front, stages

__all__ = [
    "animate",
    "contact_force",
    "cost_bars",
    "field",
    "figures_of",
    "front",
    "gap_history",
    "history",
    "motion",
    "plot_file",
    "positions",
    "side_by_side",
    "stages",
    "write_figure",
]
