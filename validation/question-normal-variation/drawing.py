"""Figure of the case: how far runs are apart, over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure
from questions import BLUE, GREY, ORANGE, REFERENCE

from mpmfw.plots.style import dress, legend_below, new_figure

if TYPE_CHECKING:
    from differences import Difference

LOOKS: dict[str, dict[str, Any]] = {
    "with Q": {"color": BLUE, "label": "Q term"},
    "kappa 0.1, with Q": {"color": ORANGE, "linestyle": "-.", "label": "Q term, κ = 0.1"},
    "shorter step": {"color": GREY, "linestyle": (0, (4, 1.5)), "label": "time step shorter by 30 %"},
}
PANELS = (
    ("no slip", "change of displacement [% of 10 m]", 1.0, "time [s]"),
    ("slip", "change of displacement [% of 10 m]", 1.0, "time [s]"),
    ("rings", "change of impulse [% of the total]", 1e3, "time [ms]"),
)


def draw(found: Mapping[tuple[str, str], Difference]) -> Figure:
    """One panel for each scene."""
    panels = [panel for panel in PANELS if any(scene == panel[0] for scene, _ in found)]
    figure = new_figure(len(panels), 1, 58.0)
    handles = {}
    for number, (axes, (scene, label, scale, unit)) in enumerate(
        zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True)
    ):
        for name, look in LOOKS.items():
            if (scene, name) in found:
                run = found[scene, name]
                handles[name] = axes.plot(scale * run.time, run.values, linewidth=1.1, **look)[0]
        axes.axhline(0.0, **{**REFERENCE, "linewidth": 0.5})
        rolling = "" if scene == "rings" else "rolling, "
        dress(axes, unit, label, f"({'abc'[number]}) {rolling}{scene}")
        if scene != "rings":
            for limit in (-0.06, 0.06):
                axes.axhline(limit, **REFERENCE)
            axes.text(0.0, 0.058, "±0.06 %", va="top")
    lines = [handles[name] for name in LOOKS if name in handles]
    legend_below(figure, [lines] if len(panels) > 1 else [[line] for line in lines])
    return figure
