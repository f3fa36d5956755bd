"""One self-contained page of a comparison: table, figures, costs and the conditions they hold under."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import xarray as xr
from matplotlib import rc_context
from matplotlib.figure import Figure

from mpmfw.errors import MpmfwError
from mpmfw.plots import figures_of
from mpmfw.report.table import COLUMNS, method_dims, shown, table

_STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;font-size:13px}th,td{padding:.25em .6em;
border-bottom:1px solid #ddd;text-align:right}
th:first-child,td:first-child,td.text,th.text{text-align:left}tr.bad td{color:#a33}figure{margin:2em 0}
svg{max-width:100%;height:auto}pre{background:#f6f6f6;padding:1em;overflow:auto;font-size:12px}
.wide{overflow-x:auto}"""


def write_report(
    dataset: xr.Dataset, path: str | os.PathLike[str], runs: Mapping[str, Any] | None = None
) -> None:
    """Write a comparison as one HTML page that needs no network.

    Parameters
    ----------
    dataset
        Of ``compare``.
    path
        File to write.
    runs
        Names of the runs' own files to list, such as ``{"penalty, cpdi": "penalty-cpdi.nc"}``.

    Raises
    ------
    MpmfwError
        The file cannot be written.
    """
    title = str(dataset.attrs.get("title", "Comparison of contact methods"))
    parts = [f"<h1>{escape(title)}</h1>", "<h2>Error and cost</h2>", _table(dataset)]
    for name, (figure, caption) in figures_of(dataset).items():
        parts.append(
            f'<figure id="{escape(name)}">{_svg(figure)}<figcaption>{escape(caption)}</figcaption></figure>'
        )
    parts += ["<h2>Conditions</h2>", _conditions(dataset.attrs)]
    if runs:
        files = "".join(f"<li>{escape(name)}: {escape(str(file))}</li>" for name, file in runs.items())
        parts.append(f"<h2>Runs</h2><ul>{files}</ul>")
    if isinstance(dataset.attrs.get("scene"), str):
        parts.append(f"<h2>Scene</h2><pre>{escape(dataset.attrs['scene'])}</pre>")
    page = (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{_STYLE}</style></head><body>{''.join(parts)}</body></html>\n"
    )
    try:
        with open(path, "w", encoding="utf-8") as file:
            file.write(page)
    except OSError as error:
        raise MpmfwError(f"cannot write '{os.fspath(path)}': {error.strerror}") from error


def _table(dataset: xr.Dataset) -> str:
    rows = table(dataset)
    labels = [str(dim) for dim in method_dims(dataset)]
    columns = [name for name in COLUMNS if any(name in row for row in rows)]
    heads = [escape(label.replace("_", " ")) for label in [*labels, "status"]]
    heads += [f"{escape(COLUMNS[name][0])}{_unit(COLUMNS[name][1])}" for name in columns]
    body = "".join(_row(row, labels, columns) for row in rows)
    return f'<div class="wide"><table><tr><th>{"</th><th>".join(heads)}</th></tr>{body}</table></div>'


def _unit(unit: str) -> str:
    return "" if unit == "1" else f" [{escape(unit)}]"


def _row(row: Mapping[str, Any], labels: Sequence[str], columns: Sequence[str]) -> str:
    cells = [f'<td class="text">{escape(str(row[name]))}</td>' for name in [*labels, "status"]]
    cells += [f"<td>{escape(shown(row.get(name, float('nan'))))}</td>" for name in columns]
    style = "" if row["status"] == "ok" else ' class="bad"'
    return f"<tr{style}>{''.join(cells)}</tr>"


def _conditions(attributes: Mapping[str, Any]) -> str:
    versions = attributes.get("versions")
    known = json.loads(versions) if isinstance(versions, str) and versions.startswith("{") else {}
    sentences = []
    if known:
        sentences.append(
            "Computed with " + ", ".join(f"{name} {number}" for name, number in known.items()) + "."
        )
    if "commit" in attributes:
        sentences.append(f"Commit {attributes['commit']}.")
    sentences.append(
        "CPU time is that of the steps alone: no compilation, settling, gap diagnostic or output."
    )
    sentences.append("A dash stands for what a run did not reach or store.")
    return f"<p>{escape(' '.join(sentences))}</p>"


def _svg(figure: Figure) -> str:
    """Draw a figure as inline SVG; text stays text, ids do not depend on the time."""
    buffer = io.StringIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "mpmfw"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    return text[text.index("<svg") :]
