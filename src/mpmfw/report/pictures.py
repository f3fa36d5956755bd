"""Pictures of a page: fields over time for a slider, and differences of fields."""

from __future__ import annotations

import base64
import contextlib
import io

import xarray as xr
from matplotlib.figure import Figure

from mpmfw.errors import SceneError
from mpmfw.plots.animation import Movie
from mpmfw.plots.field_figure import field, labelled
from mpmfw.plots.style import journal_style
from mpmfw.results.selection import Results, times_of

#: Most pictures of a slider, and most runs side by side.
_PICTURES, _RUNS = 12, 6
_FIELD = "von_mises"


def slides(results: Results) -> list[str]:
    """Return pictures of a field over time as PNG in base64; none where no material points are kept."""
    with contextlib.suppress(SceneError), labelled(results) as trees:  # or no pyvista for a run in space
        outputs = len(times_of(next(iter(trees.values()))))
        movie = Movie(dict(list(trees.items())[:_RUNS]), _FIELD, every=-(-outputs // _PICTURES))
        pictures = []
        for index in range(len(movie)):
            movie.show(index)
            pictures.append(_png(movie.figure))
        return pictures
    return []


def field_differences(dataset: xr.Dataset) -> dict[str, tuple[Figure, str]]:
    """Return a figure of how the field of every other contact differs from that of the first."""
    first = str(dataset["contact"].values[0])
    with contextlib.suppress(SceneError):
        caption = f"Difference of the von Mises stress from that with {first}, at the last output."
        return {"difference": (field(dataset, _FIELD, against=first), caption)}
    return {}


def _png(figure: Figure) -> str:
    content = io.BytesIO()
    with journal_style():
        figure.savefig(content, format="png", dpi=200)
    return base64.b64encode(content.getvalue()).decode("ascii")
