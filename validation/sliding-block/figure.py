"""Figure of the sliding block: its speed over time, and the fitted acceleration of every method."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.lines import Line2D

from mpmfw.campaigns.exact import incline
from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CLASSICAL, CaseRun
from mpmfw.validation.tables import QuantityTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: (contact, label): name and colour in the figure; markers are the shape functions'.
GROUPS = {
    ("penalty", ""): ("penalty", "#0072B2"),
    ("hamad2017", ""): ("hamad2017", "#56B4E9"),
    ("hamad2017", "literal"): ("hamad2017, literal", "#B2B200"),
    ("bardenhagen", ""): ("bardenhagen", "#D55E00"),
    ("bardenhagen", "criterion position"): ("bardenhagen, position", "#E69F00"),
    ("bardenhagen", "normal master"): ("bardenhagen, master", "#7F3C8D"),
    (CLASSICAL[1], ""): ("bardenhagen, position, master", "#117733"),
    ("bardenhagen", "normal specified"): ("bardenhagen, specified", "#6B6B6B"),
    ("none", ""): ("none", "#009E73"),
}
STYLES = ("-", "-", (0, (1, 1)), "-", "--", "-.", (0, (3, 1, 1, 1)), (0, (5, 2)), ":")
MARKERS = {"linear": "s", "gimp": "^", "cpdi": "o", "cpdi2": "D", "bspline": "v"}


def draw(runs: Sequence[CaseRun]) -> Figure:
    """Speed with CPDI against a t, and the acceleration over the exact one [m/s²]."""
    results = {run.method: run.results["series"].to_dataset() for run in runs}
    known = incline(runs[0].scene)
    assert known is not None
    exact = known.acceleration
    figure = new_figure(2, 1, 62.0)
    left, right = figure.subplots(1, 2)
    drawn = [key for key in GROUPS if any((m.contact, m.label) == key for m in results)]
    handles = []
    for (key, (name, colour)), style in zip(GROUPS.items(), STYLES, strict=True):
        width = 3.0 if key == ("penalty", "") else 1.2  # curves coincide: the first lies under the others
        for method, series in results.items():
            if (method.contact, method.label) == key and method.shape == "cpdi":
                speed = series["mean_velocity"].sel(body="block", axis="x").values
                left.plot(series["time"].values, speed, color=colour, linestyle=style, linewidth=width)
        if key in drawn:
            handles.append(Line2D([], [], color=colour, linestyle=style, linewidth=width, label=name))
    time = next(iter(results.values()))["time"].values
    left.plot(time[::10], exact * time[::10], "ko", markersize=3.5, fillstyle="none", linestyle="")
    handles.append(
        Line2D(
            [], [], color="k", marker="o", markersize=3.5, fillstyle="none", linestyle="", label="closed form"
        )
    )
    dress(left, "time [s]", "speed of the block [m/s]", "(a) CPDI")
    _accelerations(right, drawn, runs)
    markers = [
        Line2D([], [], color="0.3", marker=marker, markersize=4, linestyle="", label=shape)
        for shape, marker in MARKERS.items()
        if any(m.shape == shape for m in results)
    ]
    legend_below(figure, [handles[:5], handles[5:], markers])
    return figure


def _accelerations(
    axes: Any,
    drawn: list[tuple[str, str]],
    runs: Sequence[CaseRun],
) -> None:
    error = QuantityTable(measure="acceleration", relative=True)
    for row, key in enumerate(drawn):
        for run in runs:
            method = run.method
            if (method.contact, method.label) == key:
                shift = 0.14 * (list(MARKERS).index(method.shape) - 2)
                axes.plot(
                    1.0 + float(run.quantity(error) or 0.0),
                    row + shift,
                    MARKERS[method.shape],
                    color=GROUPS[key][1],
                    markersize=4,
                    fillstyle="none",
                )
    axes.axvline(1.0, color="k", linewidth=0.8)
    axes.set_yticks(range(len(drawn)), [GROUPS[key][0] for key in drawn])
    axes.invert_yaxis()
    dress(axes, "fitted acceleration over the exact one [–]", "", "(b) every shape function")
