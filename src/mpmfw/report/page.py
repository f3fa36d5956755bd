"""One self-contained page of a comparison."""

from __future__ import annotations

import io
import json
import os
from importlib.resources import files

import numpy as np
import xarray as xr
from jinja2 import Environment
from markupsafe import Markup
from matplotlib.figure import Figure

from mpmfw.plots import figures_of
from mpmfw.plots.style import journal_style
from mpmfw.report.differences import differences
from mpmfw.report.table import CHOICES, COLUMNS, COSTS, column_of, method_dims, shown, table
from mpmfw.results.references import described
from mpmfw.results.replacing import replace_bytes

#: Rows of the table of differences, and the least difference that has one.
_MOST_DIFFERENCES, _LEAST_SPREAD = 15, 1e-3


def write_report(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a comparison as one HTML page that needs no network."""
    attributes, rows = dataset.attrs, table(dataset)
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = [name for name in names if name.endswith("_error") and name not in COLUMNS]
    columns += [name for name in COLUMNS if name in names]
    labels = [str(dim) for dim in method_dims(dataset)]
    force = dataset.get("contact_force")
    versions = attributes.get("versions")
    page = Environment(autoescape=True).from_string(
        files(__package__).joinpath("page.html").read_text("utf-8")
    )
    text = page.render(
        title=attributes.get("title", "Comparison of contact methods"),
        reference=described(dataset),
        untouched=force is not None and not np.nan_to_num(force.values).any(),
        rows=rows,
        labels=labels + [name for name in CHOICES if name in names and name not in labels],
        columns=columns,
        accuracy=[name for name in columns if name not in COSTS],
        costs=COSTS,
        column_of=column_of,
        shown=shown,
        nan=np.nan,
        methods=[f"{a}, {b}" for a in dataset["contact"].values for b in dataset["shape"].values],
        differences=[one for one in differences(dataset) if one.spread >= _LEAST_SPREAD],
        most=_MOST_DIFFERENCES,
        notes=json.loads(attributes.get("notes", "{}")),
        figures=figures_of(dataset),
        svg=_svg,
        versions=json.loads(versions) if isinstance(versions, str) and versions.startswith("{") else {},
        commit=attributes.get("commit"),
        scene=attributes.get("scene"),
    )
    replace_bytes(text.encode("utf-8", "replace"), path)


def _svg(figure: Figure) -> Markup:
    buffer = io.StringIO()
    with journal_style():
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    return Markup(text[text.index("<svg") :])
