"""Finite elements of the resolution of [H17], and the figures of the case."""

from __future__ import annotations

import functools
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import xarray as xr
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from stresses import TIMES, Stresses, reference_stresses, stresses_of

from mpmfw.plots.style import Look, dress, legend_below, new_figure
from mpmfw.validation import CONTACTS, SHAPES, CaseRun

sys.path.insert(0, str(Path(__file__).parents[1] / "finite-elements"))
from rings_fem import Collision, collide
from rings_fem.figures import draw_von_mises

MOST = 20e6  #: end of the colour scale of [H17] [Pa]


@functools.cache
def collision() -> Collision:
    """Return rings of four-node quadrilaterals of 2 mm."""
    return collide(2e-3, end=TIMES[-1], times=TIMES)


def stresses() -> dict[str, float]:
    """Return the 95th percentile and the mean of the elements' von Mises stress [Pa]."""
    found = {}
    for snapshot in collision().snapshots[1:]:
        at = f"{1e3 * snapshot.time:.1f} ms"
        found |= {f"p95 {at}": snapshot.percentile(95.0), f"mean {at}": snapshot.mean}
    return found


def beside_finite_elements(runs: Sequence[CaseRun]) -> Figure:
    """[H17] fig. 3: material points left, finite elements right, one row for each time."""
    recommended = next(run for run in runs if run.method.recommended)
    points, elements = stresses_of(recommended.results), collision()
    figure = new_figure(2, 4, 60.0)
    panels = figure.subplots(4, 2, sharex=True, sharey=True)
    for k, ((left, right), time) in enumerate(zip(panels, TIMES, strict=True)):
        _draw_points(left, points, k)
        drawn = draw_von_mises(right, elements.snapshots[k], elements.mesh, MOST)
        dress(left, "x [mm]", "y [mm]", f"{1e3 * time:.1f} ms: CPDI, points of 0.5 mm")
        dress(right, "x [mm]", "y [mm]", f"{1e3 * time:.1f} ms: finite elements of 2 mm")
        for axes in (left, right):
            axes.label_outer()
            axes.set_axisbelow(True)
    bar = figure.colorbar(drawn, ax=panels, location="bottom", shrink=0.6, aspect=40, extend="max", pad=0.015)
    bar.set_label("von Mises stress [MPa]")
    return figure


def _draw_points(axes: Any, stresses: Stresses, k: int) -> None:
    """Each point's domain, as finite elements are drawn."""
    drawn = PolyCollection(
        list(1e3 * stresses.domains[k]), array=1e-6 * stresses.von_mises[k], cmap="turbo", linewidth=0.3
    )
    drawn.set_edgecolor("face")
    drawn.set_clim(0.0, 1e-6 * MOST)
    drawn.set_rasterized(True)
    axes.add_collection(drawn)
    axes.set_xlim(-90.0, 90.0)
    axes.set_ylim(-62.0, 62.0)
    axes.set_aspect("equal")


def histories(runs: Sequence[CaseRun]) -> Figure:
    """95th percentile and mean of every method over the fine finite elements' at each time."""
    figure = new_figure(2, 1)
    panels = figure.subplots(1, 2)
    look = Look(xr.Dataset(coords={"contact": list(CONTACTS), "shape": list(SHAPES)}))
    chosen = {run.method: stresses_of(run.results) for run in runs if not run.method.label}
    for axes, name, part, words in zip(
        panels, ("p95", "mean"), (0.10, 0.15), ("(a) 95th percentile", "(b) mean"), strict=True
    ):
        for turn, (method, stresses) in enumerate(chosen.items()):
            marker = look.line(method.contact, method.shape, 1, 0)
            for k, time in enumerate(TIMES[1:], start=1):
                value = stresses.percentile(k, 95.0) if name == "p95" else stresses.mean(k)
                ratio = 1e-6 * value / reference_stresses(time)[name]
                place = k + 0.05 * (turn - 0.5 * (len(chosen) - 1))
                axes.plot(place, ratio, marker["marker"], color=marker["color"], markersize=3.5)
        axes.axhline(1.0, color="black", linewidth=0.8)
        axes.axhspan(1.0 - part, 1.0 + part, color="0.5", alpha=0.15, linewidth=0.0)
        dress(axes, "time [ms]", "over fine finite elements", words)
        axes.set_xticks([1, 2, 3], [f"{1e3 * time:.1f}" for time in TIMES[1:]])
    colours, styles = look.key()
    for style in styles:
        if isinstance(style, Line2D):
            style.set_linestyle("")
    legend_below(figure, [colours, styles])
    return figure
