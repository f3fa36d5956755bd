"""Rolling cylinder, figure 2 of [H17]: the gap that the classical contact opens, with CPDI2.

The rigid cylinder moves by 10 m; [H17] does not say when its last picture is taken. The discretisation is
that of [H17], which has 517 segments on both surfaces, and edges to 0.2 m. The cylinder may have three
more, so that their number is a multiple of four; gravity stretches edges by a thousandth in settling.
"""
# cost: 40

import numpy as np
import rolling
from common import POSITION
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from rolling import BODY, motion_of

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CLASSICAL, Runs, methods, together

_COLOURS = {"penalty": "#0072B2", **dict(zip(CLASSICAL, ("#D55E00", "#117733"), strict=True))}
_GREY = {"plane": "0.85", BODY: "0.93"}
_SHADE = 0.35  #: of the marked quarter
_HEIGHTS = (32.0, 46.0, 46.0)  #: of the panels [mm]
_ZOOM = (2.1, 0.9)  #: size of the enlarged window [m]
_TOP = 0.8  #: of the plane [m]
_CELLS = {"color": "#117733", "linewidth": 0.7, "linestyle": (0, (4, 3)), "zorder": 1.5}


def counted(runs):
    """Return the number of segments of both surfaces, and each body's longest edge of a domain [m]."""
    tree, edges = next(run.results for run in runs if run.method.recommended), {}
    for body, group in tree["particles"].children.items():
        corners = np.asarray(group["corners"].isel(time=0))
        edges[body] = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max()
    return sum(group.sizes["surface_node"] for group in tree["surface"].children.values()), edges


def draw(every):
    """Draw a column for each method: the plane, and where the bodies meet at the start and at the end."""
    runs = {run.method: run.results for run in every if not run.method.label}
    patch, line = {"edgecolor": "0.45", "linewidth": 0.4}, {"color": "0.15", "linewidth": 1.3}
    key = [
        Patch(facecolor="0.93", label="particles' domains", **patch),
        Patch(facecolor="0.7", label="a quarter, marked", **patch),
        Line2D([], [], marker="o", markersize=2.5, label="surface, nodes", **line),
        Line2D([], [], **_CELLS, label="cells of the grid"),
    ]
    figure = new_figure(len(runs), 1, sum(_HEIGHTS))
    panels = figure.subplots(3, len(runs), squeeze=False, height_ratios=_HEIGHTS)
    for column, (method, tree) in zip(panels.T, runs.items(), strict=True):
        _whole(column[0], method, tree)
        for axes, frame in zip(column[1:], (0, -1), strict=True):
            _near(axes, method, tree, frame)
    legend_below(figure, [key])
    return figure


def _whole(axes, method, tree):
    for frame in (0, -1):
        _domains(axes, method, tree, frame, 0.15)
        _surfaces(axes, method, tree, frame, 0.7, "")
    axes.set(aspect="equal", xlim=(-0.4, 20.4), ylim=(-0.3, 5.0))
    dress(axes, "x [m]", "y [m]", str(method))  # times are in the titles below
    axes.grid(False)


def _near(axes, method, tree, frame):
    """Enlarge the place under the cylinder's centre, with the cells of the grid."""
    h = float(tree.attrs["cell_size"])
    centre = float(tree[f"particles/{BODY}"]["position"].isel(time=frame).sel(axis="x").mean())
    left, bottom = centre - 0.5 * _ZOOM[0], _TOP - 0.4 * _ZOOM[1]
    # Grid lines are at whole multiples of h from its lower corner, which the shipped scene has at -4 h
    for draw_line, first, size in ((axes.axvline, left, _ZOOM[0]), (axes.axhline, bottom, _ZOOM[1])):
        for position in h * np.arange(np.floor(first / h), np.ceil((first + size) / h) + 1):
            draw_line(position, **_CELLS)
    _domains(axes, method, tree, frame, 0.4)
    _surfaces(axes, method, tree, frame, 1.3, "o")
    axes.set(aspect="equal", xlim=(left, left + _ZOOM[0]), ylim=(bottom, bottom + _ZOOM[1]))
    motion = motion_of(tree)
    time, gap = motion.time[frame], float(motion.gap[frame])
    said = f"gap {gap:.2f} h" if gap > 0.0 else f"penetration {-gap:.3f} h"
    if gap > 0.05:
        arrow = {"arrowstyle": "<->", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (centre, _TOP), (centre, _TOP + gap * h), arrowprops=arrow)
    dress(axes, "x [m]", "y [m]", f"{time:.3f} s: {said}")
    axes.grid(False)


def _domains(axes, method, tree, frame, width):
    """Quadrilaterals of the material points; a quarter of the cylinder is dark, to show how it turned."""
    for body, group in tree["particles"].children.items():
        colours = _GREY[body]
        if body == BODY:
            start = group["position"].isel(time=0).values
            marked = (start > start.mean(axis=0)).all(axis=1)
            colours = [to_rgba(_COLOURS[method.contact], _SHADE if dark else 0.1) for dark in marked]
        look = {"facecolors": colours, "edgecolors": "0.45", "linewidths": width}
        axes.add_collection(PolyCollection([*group["corners"].isel(time=frame).values], **look))


def _surfaces(axes, method, tree, frame, width, marker):
    for body, group in tree["surface"].children.items():
        start = group["position"].isel(time=frame).values
        segments = np.stack([start, start[group["next"].values]], axis=1)
        colour = _COLOURS[method.contact] if body == BODY else "0.15"
        style = {"color": colour, "linewidth": width, "marker": marker, "markersize": 2.5}
        axes.plot(*segments.transpose(2, 1, 0), **style)


END = rolling.SLIP.end
slip = Runs(
    "slip",
    "rolling-cylinder-slip",
    [
        *methods(["penalty", "bardenhagen"], ["cpdi2"]),
        *methods(CLASSICAL[1:], ["cpdi2"], when="full"),
        *methods(["bardenhagen"], ["cpdi2"], {"criterion = position": POSITION}, when="full"),
    ],
    set={"time.end": END, "time.output_interval": END / 4},
    binds=["bardenhagen, cpdi2"],
)


@slip
def test_slip(run):
    gap = run.of(rolling.errors, "gap", roll="slip")
    if run.method.matches("penalty, *"):
        run.gate("gap at 1.663 s", gap, "penetrates by ≤ 0.03 h", (-0.03, 0.0), "h")
    else:
        binds = run.method.matches("bardenhagen, cpdi2")
        run.gate("gap at 1.663 s", gap, "about a cell ([H17], fig. 2)", (0.5, 1.1), "h", binds=binds)


@together(slip)
def test_discretisation(case, runs):
    segments, edges = counted(runs)
    case.gate("segments of both surfaces", segments, "[H17]: 517", (517, 520))
    for body, edge in edges.items():
        case.gate(f"longest edge of a domain of the {body}", edge, 0.2, (0.0, 0.2 * 1.005), "m")


@together(slip)
def test_figure(case, runs):
    case.figure("", draw(runs))
