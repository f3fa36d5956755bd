"""Finite elements of the resolution of [H17], and the figures of the case."""

from __future__ import annotations

import functools
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from rings import force_of, reference_impulse, series_of

from mpmfw.plots.style import Look, dress, legend_below, new_figure
from mpmfw.results.analysis import averaged, impulse
from mpmfw.results.references import rings_table
from mpmfw.state.fields import FloatArray
from mpmfw.validation import CONTACTS, SHAPES, CaseRun, Method

sys.path.insert(0, str(Path(__file__).parents[1] / "finite-elements"))
from rings_fem import Collision, distance, regenerate

INTERVAL = 5e-6  #: over which every force that is called raw is a mean: the runs' outputs [s]
FINE: dict[str, Any] = {"color": "black", "linewidth": 1.3}
COARSE: dict[str, Any] = {"color": "0.55", "linewidth": 1.0, "linestyle": (0, (4, 1.5))}
#: Of penalty with CPDI, by label.
LOOKS: dict[str, dict[str, Any]] = {
    "": {"color": "#0072B2", "linewidth": 1.0},
    "kappa 1": {"color": "#D55E00", "linewidth": 0.9, "linestyle": (0, (3, 1, 1, 1))},
    "cells 1 mm": {"color": "#009E73", "linewidth": 0.9, "linestyle": (0, (1, 1))},
}
NAMES = {"": "penalty, CPDI, κ = 0.25", "kappa 1": "κ = 1", "cells 1 mm": "κ = 0.25, cells of 1 mm"}


@dataclass(frozen=True)
class Curves:
    """One run's outputs."""

    time: FloatArray  #: [s]
    force: FloatArray  #: on the right ring, mean over each output interval [N/m]
    kinetic: FloatArray  #: of both rings [J/m]

    @property
    def impulse(self) -> FloatArray:
        """Since the start [N s/m]."""
        return impulse(self.time, self.force)


def curves_of(tree: xr.DataTree) -> Curves:
    """Force and kinetic energy of a run."""
    series = series_of(tree)
    time, force = force_of(series)
    return Curves(time, force, series["kinetic_energy"].sum("body").values)


@functools.cache
def collision() -> Collision:
    """Return rings of four-node quadrilaterals of 2 mm."""
    return regenerate()


def apart() -> dict[str, float]:
    """Return distances from the fine elements: ``total``, ``impulse``, ``force`` and ``kinetic``."""
    found = distance(collision())
    return {name: float(getattr(found, name)) for name in ("total", "impulse", "force", "kinetic")}


def forces(every: Sequence[CaseRun]) -> Figure:
    """[H17] fig. 4: the force as it comes, and averaged over 50, 100 and 200 µs."""
    figure = new_figure(2, 2, 55.0)
    panels = figure.subplots(2, 2, sharex=True)
    runs, elements = _of_penalty(_curves(every)), collision()
    for axes, window, name in zip(
        panels.flat, (INTERVAL, 50e-6, 100e-6, 200e-6), ("(a) raw,", "(b)", "(c)", "(d)"), strict=True
    ):
        for label, run in runs.items():
            if window > INTERVAL or not label:
                force = run.force if window == INTERVAL else averaged(run.time, run.impulse, window)
                axes.plot(1e3 * run.time, 1e-3 * force, **LOOKS[label], zorder=3 if not label else 2)
        time = next(iter(runs.values())).time
        axes.plot(1e3 * time, 1e-3 * averaged(time, reference_impulse(time), window), **FINE, zorder=2.5)
        if window > INTERVAL:
            own = np.interp(time, elements.time, elements.impulse)
            axes.plot(1e3 * time, 1e-3 * averaged(time, own, window), **COARSE)
        below = "time [ms]" if axes in panels[1] else ""
        dress(axes, below, "force [kN/m]", f"{name} mean over {1e6 * window:.0f} µs")
        axes.set_xlim(0.0, 3.2)
    legend_below(figure, _key(runs))
    return figure


def impulse_and_energy(every: Sequence[CaseRun]) -> Figure:
    """Draw impulse and kinetic energy, and their departures from the fine finite elements."""
    figure = new_figure(2, 2, 55.0)
    (left, right), (below_left, below_right) = figure.subplots(2, 2, sharex=True)
    runs, energy, elements = _of_penalty(_curves(every)), rings_table("energy"), collision()
    time = next(iter(runs.values())).time
    exact = reference_impulse(time)
    kinetic = np.interp(time, energy["time"], energy["fine_kinetic_J_per_m"])
    left.plot(1e3 * time, exact, **FINE)
    right.plot(1e3 * time, 1e-3 * kinetic, **FINE)
    drawn = [(LOOKS[label], run.time, run.impulse, run.kinetic) for label, run in runs.items()]
    drawn.append((COARSE, elements.time, elements.impulse, elements.kinetic))
    for look, at, impulses, kinetics in drawn:
        ours, theirs = np.interp(time, at, impulses), np.interp(time, at, kinetics)
        left.plot(1e3 * time, ours, **look)
        right.plot(1e3 * time, 1e-3 * theirs, **look)
        below_left.plot(1e3 * time, 100.0 * (ours - exact) / exact[-1], **look)
        below_right.plot(1e3 * time, 100.0 * (theirs - kinetic) / kinetic[0], **look)
    for axes, limit in ((below_left, 5.0), (below_right, 8.0)):
        axes.axhspan(-limit, limit, color="0.5", alpha=0.15, linewidth=0.0)
        axes.axhline(0.0, **FINE)
        axes.set_xlim(0.0, 3.2)
    dress(left, "", "impulse [kN ms/m]", "(a) impulse")
    dress(right, "", "kinetic energy [kJ/m]", "(b) kinetic energy")
    dress(below_left, "time [ms]", "departure [% of the total]", "(c) impulse, gate ±5 %")
    dress(below_right, "time [ms]", "departure [% of the start]", "(d) kinetic energy, gate ±8 %")
    legend_below(figure, _key(runs))
    return figure


def methods_compared(every: Sequence[CaseRun]) -> Figure:
    """Draw force over 100 µs and impulse: all contacts with CPDI, all shapes with penalty."""
    curves = _curves(every)
    figure = new_figure(2, 2, 55.0)
    panels = figure.subplots(2, 2, sharex=True, sharey="row")
    look = Look(xr.Dataset(coords={"contact": list(CONTACTS), "shape": list(SHAPES)}))
    position = Line2D([], [], color="#7F3C8D", linewidth=2.5, label="bardenhagen, criterion position")
    groups = (
        [m for m in curves if m.shape == "cpdi" and m.label in ("", "criterion position")],
        [m for m in curves if m.contact == "penalty" and not m.label],
    )
    for column, (group, words) in enumerate(zip(groups, ("with CPDI", "with penalty contact"), strict=True)):
        above, below = panels[0][column], panels[1][column]
        for turn, method in enumerate(group):
            run = curves[method]
            kind = look.line(method.contact, method.shape, len(run.time), turn)
            kind["color"] = "#7F3C8D" if method.label else kind["color"]
            above.plot(1e3 * run.time, 1e-3 * averaged(run.time, run.impulse, 100e-6), **kind)
            below.plot(1e3 * run.time, run.impulse, **kind)
        time = curves[group[0]].time
        exact = reference_impulse(time)
        above.plot(1e3 * time, 1e-3 * averaged(time, exact, 100e-6), **FINE, zorder=2.5)
        below.plot(1e3 * time, exact, **FINE, zorder=2.5)
        dress(above, "", "force [kN/m]", f"({'ab'[column]}) force over 100 µs, {words}")
        dress(below, "time [ms]", "impulse [kN ms/m]", f"({'cd'[column]}) impulse, {words}")
        below.set_xlim(0.0, 3.2)
    colours, styles = look.key()
    legend_below(figure, [[_line(FINE, "finite elements, 0.5 mm"), *colours], [position], styles])
    return figure


def _curves(runs: Sequence[CaseRun]) -> dict[Method, Curves]:
    return {run.method: curves_of(run.results) for run in runs}


def _of_penalty(curves: Mapping[Method, Curves]) -> dict[str, Curves]:
    chosen = {m.label: run for m, run in curves.items() if (m.contact, m.shape) == ("penalty", "cpdi")}
    return {label: chosen[label] for label in LOOKS if label in chosen}


def _key(runs: Mapping[str, Curves]) -> list[list[Line2D]]:
    return [
        [_line(FINE, "finite elements, 9-node, 0.5 mm"), _line(COARSE, "finite elements, 4-node, 2 mm")],
        [_line(LOOKS[label], NAMES[label]) for label in runs],
    ]


def _line(look: dict[str, Any], label: str) -> Line2D:
    return Line2D([], [], **look, label=label)
