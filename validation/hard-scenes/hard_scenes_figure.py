"""The matrix of scenes and contacts."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from mpmfw.plots.style import FONT

#: Within the limit, up to half a cell, beyond, no result, never in touch.
COLOURS = ("#9BD1B5", "#F6D08A", "#E8998D", "#D9D9D9", "#A9C9E8")
#: Gap from which on bodies count as never in touch [cells].
APART = 0.1


def matrix(found: Mapping[tuple[str, str], float], limits: Mapping[str, float]) -> Figure:
    """Deepest penetration of every scene (row) and contact (column), coloured by its limit.

    ``found`` is the least gap in cells by scene and contact, of which a run without result is missing; ``limits`` are depths.
    """
    scenes = [name for name in limits if any(name == one for one, _ in found)]
    contacts = list(dict.fromkeys(contact for _, contact in found))
    depth = -np.array([[found.get((s, c), np.nan) for c in contacts] for s in scenes])
    limit = np.array([[limits[s]] for s in scenes])
    kind = np.select([np.isnan(depth), depth < -APART, depth <= limit, depth <= 0.5], [3, 4, 0, 1], 2)
    figure = Figure(figsize=(175.0 / 25.4, 0.9 + 0.26 * len(scenes)), dpi=200, layout="constrained")
    axes = figure.subplots()
    axes.imshow(kind, cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=4.5, aspect="auto")
    for (row, column), value in np.ndenumerate(depth):
        said = (
            "failed"
            if np.isnan(value)
            else f"{max(value, 0.0):.2f}"
            if value >= -APART
            else f"gap {-value:.2f}"
        )
        axes.text(column, row, said, ha="center", va="center", fontsize=FONT)
    axes.set_xticks(range(len(contacts)), [c.replace("(", "\n(") for c in contacts], fontsize=FONT - 1)
    axes.set_yticks(range(len(scenes)), scenes, fontsize=FONT)
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    title = "Deepest penetration [cells]: green within its limit, yellow up to 0.5, red beyond; blue: never in touch"
    figure.supxlabel(title, fontsize=FONT)
    return figure
