"""Figure of the stick-slip case: friction over normal force, and sliding, over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.lines import Line2D
from slipping import FRICTION, GRAVITY, LENGTH, rate_of, sliding

from mpmfw.plots.style import dress, legend_below, new_figure
from mpmfw.validation import CLASSICAL, CaseRun

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: (contact, label): name, colour and line in the figure, with CPDI; the width tells coinciding curves apart.
GROUPS = {
    ("penalty", ""): ("penalty", "#0072B2", "-", 3.0),
    ("bardenhagen", ""): ("bardenhagen", "#D55E00", "-", 1.2),
    ("bardenhagen", "criterion position"): ("bardenhagen, position", "#E69F00", "--", 1.2),
    ("bardenhagen", "normal master"): ("bardenhagen, master", "#7F3C8D", "-.", 1.2),
    (CLASSICAL[1], ""): ("bardenhagen, position, master", "#117733", "-", 1.2),
    ("hamad2017", ""): ("hamad2017", "#56B4E9", "--", 1.6),
    ("hamad2017", "literal, step x 1"): ("hamad2017, literal", "#56B4E9", "-", 1.2),
    ("hamad2017", "literal, step x 0.25"): ("the same, step / 4", "#56B4E9", ":", 1.6),
    ("none", ""): ("none", "#009E73", ":", 1.6),
}


def draw(runs: Sequence[CaseRun]) -> Figure:
    """Force ratio, and sliding over the block's length [m], against Coulomb's rigid block."""
    results = {run.method: (run.results["series"].to_dataset(), sliding(run.results)) for run in runs}
    rate = rate_of(runs[0].results)
    figure = new_figure(2, 1, 62.0)
    left, right = figure.subplots(1, 2)
    handles = []
    for key, (name, colour, style, width) in GROUPS.items():
        look = {"color": colour, "linestyle": style, "linewidth": width}
        for method, (series, slid) in results.items():
            if (method.contact, method.label) != key or method.shape != "cpdi":
                continue
            time = series["time"].values
            if "contact_force" in series:
                force = series["contact_force"].sel(pair="block-plane").values[1:]
                left.plot(time[1:], -force[:, 0] / force[:, 1], **look)
            right.plot(time, 1e3 * slid / LENGTH, **look)
            handles.append(Line2D([], [], label=name, **look))
    start, end = FRICTION * GRAVITY / rate, max(float(s["time"].values[-1]) for s, _ in results.values())
    time = np.linspace(0.0, end, 24)
    exact = {"color": "k", "marker": "o", "markersize": 3.5, "fillstyle": "none", "linestyle": ""}
    left.plot(time, np.minimum(rate * time / GRAVITY, FRICTION), **exact)
    right.plot(time, 1e3 * rate * np.maximum(time - start, 0.0) ** 3 / 6.0 / LENGTH, **exact)
    handles.append(Line2D([], [], label="closed form", **exact))
    right.axhline(1.0, color="k", linewidth=0.8)
    right.annotate("threshold", (0.45 * end, 1.0), xytext=(0, 2), textcoords="offset points")
    right.set_ylim(-0.3, 4.0)
    dress(left, "time [s]", "friction over normal force [–]", "(a) force, CPDI")
    dress(right, "time [s]", "sliding / length of the block [10⁻³]", "(b) sliding, CPDI")
    legend_below(figure, [handles[:4], handles[4:]])
    return figure
