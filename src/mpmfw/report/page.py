"""One self-contained page of a run or a comparison: what differs most, pictures, tables."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import Environment
from markupsafe import Markup
from matplotlib.figure import Figure

from mpmfw.errors import SceneError
from mpmfw.plots import figures_of
from mpmfw.plots.style import drawn_reference, journal_style
from mpmfw.report.differences import differences, summary_of_comparison, summary_of_run
from mpmfw.report.pictures import field_differences, slides
from mpmfw.report.table import CHOICES, COLUMNS, COSTS, column_of, meaning_of, method_dims, shown, table
from mpmfw.results.references import described
from mpmfw.results.replacing import replace_bytes
from mpmfw.results.selection import Results, opened, series_of

#: Rows of the table of differences, and the least difference that has one.
_MOST_DIFFERENCES, _LEAST_SPREAD = 15, 1e-3


def write_report(results: Results, path: str | os.PathLike[str]) -> None:
    """Write a run or a comparison as one HTML page that needs no network.

    A SceneError says if the results hold neither.
    """
    with opened(results) as found:
        dataset = series_of(found)
        if isinstance(found, xr.DataTree):
            parts = _run(found, dataset)
        elif "status" in dataset and dataset.attrs.get("kind") not in ("study", "stability"):
            parts = _comparison(dataset)
        elif "status" in dataset or "class" in dataset:
            parts = {"figures": figures_of(dataset)}
        else:
            raise SceneError("report: holds no run, comparison, study or map")
        attributes = dict(found.attrs)
        page = Environment(autoescape=True).from_string(
            files(__package__).joinpath("page.html").read_text("utf-8")
        )
        versions = attributes.get("versions")
        text = page.render(
            title=attributes.get("title") or attributes.get("study") or "Results of mpmfw",
            svg=_svg,
            versions=json.loads(versions) if isinstance(versions, str) and versions.startswith("{") else {},
            commit=attributes.get("commit"),
            processor=attributes.get("processor"),
            timing=attributes.get("timing"),
            scene=attributes.get("scene"),
            **parts,
        )
    replace_bytes(text.encode("utf-8", "replace"), path)


def _run(tree: xr.DataTree, series: xr.Dataset) -> Mapping[str, Any]:
    notes = json.loads(tree.attrs.get("notes", "[]"))
    return {
        "summary": summary_of_run(series, tree.attrs),
        **slides(tree),
        "figures": figures_of(series),
        "notes": {"run": notes} if notes else {},
    }


def _comparison(dataset: xr.Dataset) -> Mapping[str, Any]:
    rows = table(dataset)
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = [name for name in names if name.endswith("_error") and name not in COLUMNS]
    columns += [name for name in COLUMNS if name in names]
    labels = [str(dim) for dim in method_dims(dataset)]
    methods = [f"{a}, {b}" for a in dataset["contact"].values for b in dataset["shape"].values]
    found, force = differences(dataset), dataset.get("contact_force")
    return {
        "summary": summary_of_comparison(rows, labels, methods, found),
        **slides(dataset),
        "reference": described(dataset),
        "compared": True,
        "untouched": force is not None and not np.nan_to_num(force.values).any(),
        "rows": rows,
        "labels": labels + [name for name in CHOICES if name in names and name not in labels],
        "columns": columns,
        "accuracy": [name for name in columns if name not in COSTS],
        "costs": COSTS,
        "column_of": column_of,
        "meaning_of": meaning_of,
        "judged": drawn_reference(dataset),
        "shown": shown,
        "nan": np.nan,
        "methods": methods,
        "differences": [one for one in found if one.spread >= _LEAST_SPREAD],
        "equal": [one.quantity for one in found if one.spread == 0.0 and len(methods) > 1],
        "most": _MOST_DIFFERENCES,
        "notes": json.loads(dataset.attrs.get("notes", "{}")),
        "figures": figures_of(dataset) | field_differences(dataset),
    }


def _svg(figure: Figure) -> Markup:
    buffer = io.StringIO()
    with journal_style():
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    return Markup(text[text.index("<svg") :])
