"""Finite elements of the resolution of [H17], and the figure of the case."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from stresses import TIMES, stresses_of

from mpmfw.plots.style import dress, new_figure
from mpmfw.validation import CaseRun

sys.path.insert(0, str(Path(__file__).parents[1] / "finite-elements"))
from rings_fem import collide

MOST = 20e6  #: end of the colour scale of [H17] [Pa]


def stresses() -> dict[str, float]:
    """Return the 95th percentile and the mean of the elements' von Mises stress [Pa]."""
    found = {}
    for snapshot in collide(2e-3).snapshots[1:]:
        at = f"{1e3 * snapshot.time:.1f} ms"
        found |= {f"p95 {at}": snapshot.percentile(95.0), f"mean {at}": snapshot.mean}
    return found


def beside_finite_elements(runs: Sequence[CaseRun]) -> Figure:
    """[H17] fig. 3: material points left, finite elements right, one row for each time."""
    recommended = next(run for run in runs if run.method.recommended)
    points, elements = stresses_of(recommended.results), collide(2e-3)
    figure = new_figure(2, 4, 60.0)
    panels = figure.subplots(4, 2, sharex=True, sharey=True)
    for k, ((left, right), time) in enumerate(zip(panels, TIMES, strict=True)):
        snapshot = elements.snapshots[k]
        drawn = _draw(left, points.domains[k], points.von_mises[k])
        _draw(right, snapshot.points[elements.mesh.elements], snapshot.element_von_mises)
        dress(left, "x [mm]", "y [mm]", f"{1e3 * time:.1f} ms: CPDI, points of 0.5 mm")
        dress(right, "x [mm]", "y [mm]", f"{1e3 * time:.1f} ms: finite elements of 2 mm")
        for axes in (left, right):
            axes.label_outer()
            axes.set_axisbelow(True)
    bar = figure.colorbar(drawn, ax=panels, location="bottom", shrink=0.6, aspect=40, extend="max", pad=0.015)
    bar.set_label("von Mises stress [MPa]")
    return figure


def _draw(axes: Any, corners: np.ndarray, von_mises: np.ndarray) -> PolyCollection:
    """Draw quadrilaterals (n, 4, 2) [m], coloured by their stress [Pa], in mm and MPa."""
    drawn = PolyCollection(list(1e3 * corners), array=1e-6 * von_mises, cmap="turbo", linewidth=0.3)
    drawn.set_edgecolor("face")
    drawn.set_clim(0.0, 1e-6 * MOST)
    drawn.set_rasterized(True)
    axes.add_collection(drawn)
    axes.set_xlim(-90.0, 90.0)
    axes.set_ylim(-62.0, 62.0)
    axes.set_aspect("equal")
    return drawn
