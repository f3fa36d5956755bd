"""Pictures of a page: fields over time for a slider, in space to be turned, and differences of fields."""

from __future__ import annotations

import base64
import contextlib
import html
import importlib
import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from markupsafe import Markup
from matplotlib.figure import Figure

from mpmfw.errors import SceneError
from mpmfw.plots.animation import frames_at, movie
from mpmfw.plots.bodies import Bodies, colour_range
from mpmfw.plots.field_figure import field, labelled
from mpmfw.plots.style import in_brackets, journal_style
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
    drawing, pictures = movie(trees, _FIELD, times, limits=limits), []
    for index in range(len(times)):
        drawing.show(index)
        content = io.BytesIO()
        with journal_style():
            drawing.figure.savefig(content, format="png", dpi=200)
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


#: Most runs of a page; height of a row [px]; the viewer's place, the scene being 1 wide.
MOST, _HEIGHT, _EYE = 4, 480, {"x": 1.3, "y": 0.9, "z": 1.9}


def turning(
    trees: Mapping[str, xr.DataTree],
    times: FloatArray,
    field: str,
    limits: tuple[float, float] | None,
) -> Markup | None:
    """Return HTML with the script that draws a field of runs in 3D at some times [s]; None without plotly.

    The runs have labels as keys; the first four are drawn. The page loads nothing.
    """
    try:
        subplots = importlib.import_module("plotly.subplots")
    except ImportError:
        return None
    shown = {label: Bodies(tree) for label, tree in list(trees.items())[:MOST]}
    frames = {label: frames_at(runs.tree, times) for label, runs in shown.items()}
    columns = min(len(shown), 2)
    rows = -(-len(shown) // columns)
    figure = subplots.make_subplots(
        rows, columns, specs=[[{"type": "scene"}] * columns] * rows, horizontal_spacing=0.02,
        vertical_spacing=0.05, subplot_titles=[html.escape(label) for label in shown],
    )  # fmt: skip
    start, axes = _axes(shown, frames)
    drawn = [
        [
            _trace(runs, body, field, frames[label][step], start) | {"scene": f"scene{number}"}
            for number, (label, runs) in enumerate(shown.items(), 1)
            for body in runs.names
        ]
        for step in range(len(times))
    ]
    figure.add_traces(drawn[-1])
    figure.frames = [{"name": str(step), "data": traces} for step, traces in enumerate(drawn)]
    figure.update_layout(height=_HEIGHT * rows + 180, sliders=[_slider(times)])
    figure.update_scenes(aspectmode="data", camera={"up": {"x": 0, "y": 1, "z": 0}, "eye": _EYE}, **axes)
    _scale(figure, shown, frames, field, limits)
    settings = {"displayModeBar": False, "responsive": True, "scrollZoom": True}
    options = {"auto_play": False, "full_html": False, "div_id": "turning", "include_plotlyjs": True}
    return Markup(figure.to_html(settings, **options))


def _scale(
    figure: Any,
    shown: Mapping[str, Bodies],
    frames: Mapping[str, Sequence[int]],
    field: str,
    limits: tuple[float, float] | None,
) -> None:
    """Give all scenes and outputs the same colours."""
    first = next(iter(shown.values()))
    about = point_field(frame_of(first.tree, f"particles/{first.bodies[0]}", 0), field).attrs
    ends = [runs.extremes(field, frames[label]) for label, runs in shown.items()]
    low, high, colours = colour_range(ends, limits)
    bar = {
        "title": {"text": html.escape(in_brackets(about["long_name"], about["units"])), "side": "top"},
        "tickformat": "~s", "orientation": "h", "yref": "container", "y": 1.0,
        "yanchor": "top", "thickness": 12,
    }  # fmt: skip
    figure.update_layout(
        margin={"l": 10, "r": 10, "t": 110, "b": 0}, showlegend=False,
        coloraxis={"cmin": low, "cmax": high, "colorscale": colours, "colorbar": bar},
    )  # fmt: skip


def _axes(
    shown: Mapping[str, Bodies], frames: Mapping[str, Sequence[int]]
) -> tuple[FloatArray, dict[str, dict[str, Any]]]:
    """Return the origin of the drawn coordinates (3,) [m], and the axes of all scenes and outputs.

    Browsers draw in single precision, which would shift points far from the scene's origin."""
    boxes = np.array([runs.box(frames[label]) for label, runs in shown.items()])
    lower, upper = boxes.min(axis=(0, 1)), boxes.max(axis=(0, 1))
    size = float(np.ptp([lower, upper], axis=0).max())
    rounding = np.finfo(np.float32).eps * np.abs([lower, upper]).max(axis=0)
    start = np.where(rounding > 1e-4 * size, lower, 0.0)
    titles = [f"{axis} − {at:.10g} m" if at else axis for axis, at in zip("xyz", start.tolist(), strict=True)]
    ends = np.array([lower - start, upper - start]).T.tolist()
    return start, {
        f"{axis}axis": {"range": between, "title": {"text": f"{title} [m]"}}
        for axis, between, title in zip("xyz", ends, titles, strict=True)
    }


def _trace(runs: Bodies, body: str, field: str, frame: int, start: FloatArray) -> dict[str, Any]:
    """Return the trace of a body at one output, relative to ``start`` [m]: a surface, else dots."""
    places, facets = (runs.places(body, frame) - start).astype(np.float32), runs.facets(body)
    trace = dict(zip("xyz", places.T, strict=True), name=html.escape(body))
    colours: dict[str, Any] = {"color": "lightgrey"}
    if body in runs.bodies:
        values = runs.values(body, field, frame).astype(np.float32)
        colours = {"color" if facets is None else "intensity": values, "coloraxis": "coloraxis"}
    if facets is None:
        return trace | {"type": "scatter3d", "mode": "markers", "marker": {"size": 4, **colours}}
    return trace | {"type": "mesh3d", **dict(zip("ijk", facets.T, strict=True)), **colours}


def _slider(times: FloatArray) -> dict[str, Any]:
    """Return a slider that shows the frames of these times, and begins with the last."""
    at_once = {"mode": "immediate", "frame": {"duration": 0, "redraw": True}, "transition": {"duration": 0}}
    steps: list[dict[str, Any]] = [
        {"label": f"{time:.4g} s", "method": "animate", "args": [[str(step)], at_once]}
        for step, time in enumerate(times)
    ]
    return {"active": len(steps) - 1, "steps": steps, "currentvalue": {"prefix": "t = "}, "pad": {"b": 30}}
