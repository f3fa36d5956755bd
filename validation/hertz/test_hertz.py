"""Hertz line contact: half-width and largest pressure, for every method and over the cell size.

Largest pressure within 10 %, half-width within one cell, each measured in two ways. 2 and 4 cells in the
half-width; the scene has 3.
"""
# cost: 100

import numpy as np
from common import POSITION, nodes_of, specified

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import SHAPES, Place, Runs, full, methods, together

RADIUS, CENTRE = 1.0, 0.011  #: of the cylinder, and abscissa of its centre [m]
WEIGHT = 1000.0 * 10.0 * np.pi * RADIUS**2  #: F' [N/m]
YOUNG, POISSON = 1.6e6, 0.3  #: of the cylinder; the plane's E is 1000 times that
#: 1/E* = (1 − ν²)/E of the cylinder + (1 − ν²)/E of the plane [Pa]
E_STAR = YOUNG / (1.0 - POISSON**2) / (1.0 + 1e-3)
#: Hertz: half-width of the contact [m] and largest pressure [Pa]; K. L. Johnson, Contact Mechanics (1985),
#: section 4.2(c)
HALF_WIDTH = float(np.sqrt(4.0 * WEIGHT * RADIUS / (np.pi * E_STAR)))
PEAK = float(np.sqrt(WEIGHT * E_STAR / (np.pi * RADIUS)))


def errors_of(x, load, size, h):
    """Return errors of the contact pressure Σ load / Σ size, averaged over windows of a cell round x = 0.

    Of the ``peak`` and of p0, ``fitted peak`` [%], and of b, ``width`` [cells]: p² = p0² (1 − x²/b²) is
    fitted to windows above a fifth of the peak, within 4 half-widths."""
    window = np.floor(x / h + 0.5).astype(int)
    chosen = [window == k for k in np.unique(window) if abs(k * h) < 4.0 * HALF_WIDTH]
    x = np.array([np.average(x[own], weights=size[own]) for own in chosen])
    pressure = np.array([load[own].sum() / size[own].sum() for own in chosen])
    peak, width = np.nan, np.nan
    high = pressure > 0.2 * pressure.max()
    if high.sum() >= 3:
        slope, level = np.polyfit(x[high] ** 2, pressure[high] ** 2, 1)
        if level > 0.0 and slope < 0.0:
            peak, width = np.sqrt(level), np.sqrt(-level / slope)
    return {
        "peak": float(100.0 * (pressure.max() / PEAK - 1.0)),
        "fitted peak": float(100.0 * (peak / PEAK - 1.0)),
        "width": float(width - HALF_WIDTH) / h,
    }


def of_forces(tree):
    """Return errors by contact forces over tributary length.

    Besides, that of half the distance between the outermost nodes that carry force, ``touching`` [cells]."""
    position, force, length = nodes_of(tree, "cylinder", -1)
    low, h = position[:, 1] < 0.5 * RADIUS, float(tree.attrs["cell_size"])
    x, force = position[low, 0] - CENTRE, force[low, 1]
    active = x[force > 0.0]
    touching = 0.5 * float(np.ptp(active)) if len(active) else np.nan
    return {**errors_of(x, force, length[low], h), "touching": (touching - HALF_WIDTH) / h}


def of_stress(tree):
    """Return errors by −σ_yy of points within half a cell of the rim, weighted by volume."""
    points, h = tree["particles/cylinder"].to_dataset(), float(tree.attrs["cell_size"])
    end = points.isel(time=-1)
    position = end["position"].values
    # The deformed underside: settled by far less than a cell outside the contact
    rim = tree["surface/cylinder"]["position"].values[-1]
    rim = rim[rim[:, 1] < 0.5 * RADIUS]
    rim = rim[np.argsort(rim[:, 0])]
    depth = position[:, 1] - np.interp(position[:, 0], rim[:, 0], rim[:, 1])
    near = (depth < 0.5 * h) & (position[:, 1] < 0.5 * RADIUS)
    volume = points["volume"].isel(time=0).values[near]
    load = -end["stress"].values[near, 1, 1] * volume
    return errors_of(position[near, 0] - CENTRE, load, volume, h)


def by_size(runs):
    """Return cell sizes as ``h``, from the largest on [m], and magnitudes of the errors by forces."""
    ordered = sorted(runs, key=lambda run: -run.results.attrs["cell_size"])
    found = {
        key: np.abs([run.of(of_forces, key) for run in ordered]) for key in ("peak", "fitted peak", "width")
    }
    sizes = np.array([float(run.results.attrs["cell_size"]) for run in ordered])
    return {"h": sizes, **found, "width": found["width"] * sizes}


def most(runs):
    """Return the most that an error of the largest pressure is over that of the coarser cells.

    Errors below 1 % count as 1 %: they depend on where the contact lies in its cell.
    """
    counted = np.maximum(by_size(runs)["peak"], 1.0)
    return float(np.max(counted[1:] / counted[:-1]))


def draw(runs):
    """Draw errors of the largest pressure, of the fitted p0 and of the fitted b over the cell size."""
    errors = by_size(runs)
    curves = (
        ("largest pressure", errors["peak"], "#E69F00", "s"),
        ("p0 of the fit", errors["fitted peak"], "#0072B2", "o"),
        ("b of the fit", 100.0 * errors["width"] / HALF_WIDTH, "#009E73", "^"),
    )
    figure = new_figure(1, 1, 68.0)
    panel = figure.subplots()
    handles = []
    for name, values, colour, marker in curves:
        style = {"color": colour, "marker": marker, "markersize": 4, "linewidth": 1.0}
        handles += panel.loglog(HALF_WIDTH / errors["h"], values, label=name, **style)
    ends = np.array([2.0, 4.0])
    panel.loglog(ends, 8.0 * ends[0] / ends, color="0.4", linestyle="--", linewidth=0.8)
    panel.annotate("order 1", (3.3, 16.0 / 3.3), (0, 4), textcoords="offset points", color="0.3")
    panel.set_yticks(ticks := [0.2, 0.5, 1, 2, 5, 10], [f"{tick:g}" for tick in ticks])
    dress(panel, "cells in the half-width, b/h [1]", "error [%]")
    panel.set_xticks([2, 3, 4], ["2", "3", "4"])
    panel.minorticks_off()
    legend_below(figure, [handles])
    return figure


DOWN = specified(0.0, -1.0)

every = Runs(
    "methods",
    methods=[
        *methods(["penalty", "bardenhagen"], SHAPES, when="full"),
        *methods(
            ["bardenhagen"],
            settings={"normal given": DOWN, "normal given, position": {**DOWN, **POSITION}},
            when="full",
        ),
        *methods(["none"], SHAPES, when="full"),
        *methods(when="quick"),
    ],
    quick={"grid.cell_size": 0.06, "settle.tolerance": 0.001},
)
convergence = Runs(
    "convergence",
    places=[
        Place("b/h = 2.0", set={"grid.cell_size": 0.075}),
        Place("b/h = 4.0", set={"grid.cell_size": 0.0375}),
    ],
    when="full",
)


@every
def test_every(run):
    if run.method.matches("penalty, *"):
        run.gates(
            of_forces,
            ("largest pressure, error", "peak", 0.0, 10.0, "%"),
            ("p0 of the fitted semi-ellipse, error", "fitted peak", 0.0, 10.0, "%"),
            ("b of the fitted semi-ellipse, error", "width", 0.0, 1.0, "h"),
            ("b by the nodes in contact, error", "touching", 0.0, 1.0, "h"),
        )
    run.gates(
        of_stress,
        ("largest −σ_yy at the rim, error", "peak", 0.0, 10.0, "%"),
        ("b of the ellipse fitted to −σ_yy, error", "width", 0.0, 1.0, "h"),
        binds=False,
    )


@convergence
def test_convergence(run):
    """Run the other cell sizes."""


@full
@together(every, convergence)
def test_orders(case, runs):
    penalty = [run for run in runs if run.method.matches("penalty, cpdi")]
    quantity = "largest pressure, error over that of the coarser cells, at most"
    case.gate(quantity, most(penalty), tolerance=(0.0, 1.0), method="penalty, cpdi")
    case.figure("convergence", draw(penalty))
