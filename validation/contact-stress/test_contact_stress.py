"""Contact stress under a block: σ_yy = −p at the interface, also with wrong surface-to-grid maps."""
# cost: 50

from dataclasses import replace
from math import inf

import numpy as np
from common import POSITION, specified, stress

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import RECOMMENDED, SHAPES, Place, Runs, each, full, methods, together

COLOURS = ("#0072B2", "#56B4E9", "#D55E00", "#E69F00")


def draw(runs):
    """Draw L2 error and departure away from the walls over the cell size, with slopes for reference."""
    curves = {}
    for run in runs:
        found = float(run.results.attrs["cell_size"]), stress(run.results)
        curves.setdefault(str(run.method), []).append(found)
    figure = new_figure(2, 1, 62.0)
    left, right = figure.subplots(1, 2)
    handles = []
    for (label, curve), colour, marker in zip(curves.items(), COLOURS, "oDs^", strict=False):
        h = [size for size, _ in curve]
        style = {"color": colour, "marker": marker, "markersize": 3.5, "linewidth": 1.1}
        handles += left.loglog(h, [errors["l2"] for _, errors in curve], label=label, **style)
        right.loglog(h, [errors["off the walls"] for _, errors in curve], **style)
    first = next(iter(curves.values()))
    sizes, error = np.array([size for size, _ in first]), first[0][1]["l2"]
    left.loglog(sizes, 0.6 * error * np.sqrt(sizes / sizes[0]), color="0.4", linestyle="--", linewidth=0.8)
    left.annotate("order 1/2", (sizes[1], 0.42 * error), (-14, 5), textcoords="offset points", color="0.3")
    right.axhline(3.0, color="0.4", linestyle="--", linewidth=0.8)
    right.annotate("limit, 3 %", (sizes[-1], 3.0), (0, -4), textcoords="offset points", color="0.3", va="top")
    dress(left, "cell size h [m]", "L2 error of σ_yy, both blocks [%]", "(a)")
    dress(right, "cell size h [m]", "largest departure off the walls [%]", "(b)")
    for panel in (left, right):
        panel.set_xticks(sizes, [f"{size:g}" for size in sizes])
        panel.minorticks_off()
    legend_below(figure, [handles])
    return figure


GIVEN = specified(0.0, 1.0)
WRONG = {"wrong map": {"contact.penalty.map": "mass_weighted"}}
PLAIN = {"plain map": {"contact.penalty.map": "plain"}}
UNLIKE = {"bodies.upper.particles.size": "0.45 cells", "bodies.upper.segment": "0.22 cells"}
FORMS = {"": {}, "normal given": GIVEN}
#: Methods that run at every offset: the recommended ones, and classical contact in both forms.
EVERYWHERE = methods(shape=RECOMMENDED) + methods(["bardenhagen"], settings=FORMS)


def place(at, size, lower, upper):
    """Return cells of a size with the interface at a height, and the top of the upper block."""
    values = {
        "grid.cell_size": size,
        "bodies.lower.geometry.upper": [1.0, lower],
        "bodies.upper.geometry.lower": [0.0, lower],
        "bodies.upper.geometry.upper": [1.0, upper],
    }
    return Place(at, values)


every = Runs(
    "methods",
    methods=[
        *methods(shape=SHAPES, when="full"),
        *methods(shape=RECOMMENDED, settings={"unlike points and segments": UNLIKE}, when="full"),
        *methods(shape=["linear", "gimp"], settings=PLAIN, when="full"),
        *methods(shape=["bspline"], settings=WRONG, when="full"),
        *methods(["bardenhagen"], SHAPES, FORMS | {"normal given, position": GIVEN | POSITION}, when="full"),
        *methods(["none"], SHAPES, when="full"),
        *methods(when="quick"),
    ],
    places=[place("at 0.37 h", 0.1, 1.037, 2.037)],
)
higher = Runs("higher", methods=EVERYWHERE, places=[place("at 0.81 h", 0.1, 1.081, 2.081)], when="full")
#: The case has to tell a wrong map: it must miss the limit that the right one keeps.
wrong = Runs(
    "wrong",
    methods=methods(shape=RECOMMENDED, settings=WRONG, when="full") + methods(settings=WRONG, when="quick"),
    places=[*every.places, replace(higher.places[0], when="full")],
    binds=["*"],
)
#: The interface is kept at the same place within a cell.
cells = Runs(
    "convergence",
    methods=EVERYWHERE,
    places=[
        place("h = 0.2 m", 0.2, 1.074, 2.074),
        place("h = 0.1 m", 0.1, 1.037, 2.037),
        place("h = 0.05 m", 0.05, 1.0185, 2.0185),
    ],
    when="full",
)


@each(every, higher)
def test_right_map(run):
    run.gates(
        stress,
        ("mean σ_yy, error, {at}", "mean", 0.0, 3.0, "%"),
        ("largest departure, {at}", "departure", 0.0, (0.0, 3.0), "%"),
    )
    off = run.of(stress, "off the walls")
    run.gate(f"largest departure off the walls, {run.place.at}", off, 0.0, (0.0, 3.0), "%", binds=False)


@wrong
def test_wrong_map(run):
    off = run.of(stress, "off the walls")
    run.gate(f"departure off the walls, must be seen, {run.place.at}", off, "", (3.0, inf), "%", binds=True)


@cells
def test_convergence(run):
    """Run the cell sizes of the figure."""


@full
@together(cells)
def test_figure(case, runs):
    case.figure("convergence", draw(runs))
