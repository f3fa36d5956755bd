"""Static hold: a block that friction must hold, for every method.

Closed form (Coulomb): a block at rest on an incline stays at rest if tan θ ≤ μ; friction then is T = m g sin θ, so
T / N = tan θ, below μ.
"""

# cost: 65

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.lines import Line2D

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CONTACTS, SHAPES, Case, Method

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

TILT = math.radians(20.0)
HEIGHT = 0.3  # of the block [m]
MOST_DISPLACEMENT = 1e-3  # of the height
#: Of the height in the last second: a tenth of the displacement's limit, which a block creeping at this rate would
#: reach in ten seconds. What is left after settling is an oscillation, whose fit is far smaller.
MOST_DRIFT = 1e-4

CLASSICAL = {
    "criterion position": {"contact.bardenhagen.criterion": "position"},
    "normal master": {"contact.bardenhagen.normal": "master"},
}
#: [H17] with increments that add up below Coulomb's cap, and to the letter.
HAMAD = {"": {}, "literal": {"contact.hamad2017.friction_law": "literal"}}
#: Linear functions take MUSL by themselves, see the README.
UPDATE_LAST = {"USL": {"stepping.scheme": "usl"}}

COLOURS = dict(zip(CONTACTS, ("#009E73", "#D55E00", "#117733", "#0072B2"), strict=True)) | {
    "hamad2017": "#56B4E9"
}
LITERAL = "#B2B200"
STYLES = {"linear": ":", "gimp": "--", "cpdi": "-", "cpdi2": "-.", "bspline": (0, (5, 1, 1, 1, 1, 1))}


def check(case: Case) -> None:
    """Run every contact strategy with every shape function."""
    if case.quick:
        methods = case.methods(("bardenhagen",), ("cpdi",)) + case.methods(("penalty",), ("cpdi", "cpdi2"))
    else:
        methods = case.methods(CONTACTS, SHAPES)
        methods += case.methods(("bardenhagen",), SHAPES, CLASSICAL)
        methods += case.methods(("hamad2017",), ("cpdi",), HAMAD)
        methods += case.methods(("bardenhagen", "penalty"), ("linear",), UPDATE_LAST)
    results = {}
    for method, tree in case.runs(methods, set={"output.particles": False}):
        results[method] = series = tree["series"].to_dataset()
        _judge(case, method, series)
    case.figure("", _figure(results))


def _judge(case: Case, method: Method, series: xr.Dataset) -> None:
    time = series["time"].values
    moved = _moved(series)
    case.judge(
        method,
        "displacement after 2 s / height",
        float(np.hypot(*moved[-1])) / HEIGHT,
        within=(0.0, MOST_DISPLACEMENT),
        reference=0.0,
    )
    last = time >= time[-1] - 1.0
    drift = float(np.polyfit(time[last], moved[last, 0], 1)[0]) / HEIGHT
    case.judge(
        method,
        "fitted drift in the last second / height",
        drift,
        within=(-MOST_DRIFT, MOST_DRIFT),
        reference=0.0,
    )
    if "contact_force" in series:
        force = series["contact_force"].sel(pair="block-plane")[last].mean("time")
        ratio = -float(force.sel(axis="x") / force.sel(axis="y"))
        case.show("T / N in the last second", ratio, method=method, reference=math.tan(TILT))


def _moved(series: xr.Dataset) -> np.ndarray:
    """Displacement of the block's centre, (time, axis) [m]."""
    centre = series["centre_of_mass"].sel(body="block").values
    return centre - centre[0]


def _figure(results: dict[Method, xr.Dataset]) -> Figure:
    """Magnitude of the displacement over time, logarithmic, against the limit."""
    figure = new_figure(1, 1, 78.0)
    axes = figure.subplots()
    rows: list[list[Line2D]] = [[], []]
    for method, series in results.items():
        literal = method.label == "literal"
        if method.label and not literal:
            continue
        look = {
            "color": LITERAL if literal else COLOURS[method.contact],
            "linestyle": STYLES[method.shape],
            "linewidth": 1.1,
        }
        size = np.hypot(*_moved(series).T) / HEIGHT
        axes.semilogy(series["time"].values[1:], np.maximum(size[1:], 1e-12), **look)
    axes.axhline(MOST_DISPLACEMENT, color="k", linewidth=1.0)
    axes.annotate("limit", (0.5, MOST_DISPLACEMENT), xytext=(0, 2), textcoords="offset points", fontsize=7)
    axes.set_ylim(1e-10, 1.0)
    dress(axes, "time [s]", "displacement / height [–]")
    contacts = {m.contact for m in results}
    rows[0] = [
        Line2D([], [], color=colour, linewidth=2.5, label=name)
        for name, colour in COLOURS.items()
        if name in contacts
    ]
    if any(m.label == "literal" for m in results):
        rows[0].append(Line2D([], [], color=LITERAL, linewidth=2.5, label="hamad2017, literal"))
    shapes = [
        Line2D([], [], color="0.3", linestyle=style, linewidth=1.1, label=name)
        for name, style in STYLES.items()
        if name in {m.shape for m in results}
    ]
    rows = [line[k : k + 3] for line in (rows[0], shapes) for k in range(0, len(line), 3)]
    legend_below(figure, rows)
    return figure
