"""Pictures of a page: fields over time for a slider, and differences of fields."""

from __future__ import annotations

import base64
import contextlib
import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.errors import SceneError
from mpmfw.plots.animation import Movie, frames_at
from mpmfw.plots.field_figure import field, labelled
from mpmfw.plots.style import journal_style
from mpmfw.report.turning import MOST, turning
from mpmfw.results.domains import surfaces_of
from mpmfw.results.point_fields import point_field
from mpmfw.results.selection import bodies_of, frame_at, frame_of, points_of, times_of
from mpmfw.state.fields import FloatArray

#: Most pictures of a slider, and most runs side by side.
_PICTURES, _RUNS = 12, 6
_FIELD = "von_mises"

#: Share of the points, over all pictures, whose values lie within the colours.
_WITHIN = 0.98


def slides(results: xr.DataTree | xr.Dataset) -> dict[str, Any]:
    """Return ``slides``, pictures of a field over time as PNG in base64, and ``slides_say``, their caption.

    With plotly, runs in 3D are ``turned`` instead. If there are no pictures, the caption gives the reason.
    """
    try:
        with labelled(results) as trees:
            shown = dict(list(trees.items())[:_RUNS])
            longest = max(shown.values(), key=lambda tree: times_of(tree)[frame_at(tree)])
            times = times_of(longest)
            chosen = times[np.unique(np.linspace(0, len(times) - 1, _PICTURES).round().astype(int))]
            limits = _limits(shown, chosen)
            spaces = [tree for tree in shown.values() if tree.sizes.get("axis") == 3]
            turned = turning(shown, chosen, _FIELD, limits) if spaces else None
            pictures = [] if turned else _pictures(shown, chosen, limits)
    except SceneError as error:  # no points are kept, or no pyvista is there for a run in space
        why = str(error).removeprefix(f"{results.encoding.get('source')}: ")
        return {"slides_say": f"There are no pictures of the stress: {why}."}
    text = "Von Mises stress; the colour scale ends at the 98th percentile."
    if len(chosen) > 1:
        count = f"{len(chosen)} of {len(times)}" if len(chosen) < len(times) else "all"
        text += f" The slider shows {count} outputs."
    if any(set(bodies_of(tree)) - {*surfaces_of(tree)} for tree in spaces):
        text += " Bodies are drawn as dots at their material points where no surface is stored."
    if isinstance(results, xr.Dataset):
        runs = [", ".join(map(str, one.values())) for one, _ in points_of(results, results["status"].dims)]
        left = [run for run in runs if run not in list(shown)[: MOST if turned else None]]
        text += f" {len(left)} of {len(runs)} runs are left out: {'; '.join(left)}." if left else ""
    return {"slides": pictures, "turned": turned, "slides_say": text}


def _pictures(
    trees: Mapping[str, xr.DataTree], times: FloatArray, limits: tuple[float, float] | None
) -> list[str]:
    movie = Movie(trees, _FIELD, times=times, limits=limits)
    pictures = []
    for index in range(len(movie)):
        movie.show(index)
        content = io.BytesIO()
        with journal_style():
            movie.figure.savefig(content, format="png", dpi=200)
        pictures.append(base64.b64encode(content.getvalue()).decode("ascii"))
    return pictures


def _limits(trees: Mapping[str, xr.DataTree], times: FloatArray) -> tuple[float, float] | None:
    """Return ends of a colour scale that a few large values do not stretch; None if all are equal."""
    values = [
        point_field(frame_of(tree, f"particles/{body}", frame), _FIELD).values
        for tree in trees.values()
        for frame in frames_at(tree, times)
        for body in bodies_of(tree)
    ]
    low, high = np.nanquantile(np.concatenate(values), [0.0, _WITHIN])
    return (float(low), float(high)) if low < high else None


def field_differences(dataset: xr.Dataset) -> dict[str, tuple[Figure, str]]:
    """Return a figure of how the field of every other contact differs from that of the first."""
    first = str(dataset["contact"].values[0])
    with contextlib.suppress(SceneError):
        caption = (
            f"Difference of the von Mises stress from that with {first}, at the last output. "
            "Points are drawn at their positions in the run that a title names first."
        )
        return {"difference": (field(dataset, _FIELD, against=first), caption)}
    return {}
