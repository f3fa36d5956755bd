"""One self-contained page of a comparison: table, figures, costs and the conditions they hold under."""

from __future__ import annotations

import io
import json
import math
import os
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.plots import figures_of
from mpmfw.plots.style import journal_style
from mpmfw.report.columns import CHOICES, COLUMNS, COSTS, column_of
from mpmfw.report.differences import differences, refinement
from mpmfw.report.table import method_dims, shown, table
from mpmfw.results.references import described
from mpmfw.results.replacing import replace_bytes

_STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:75em;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;font-size:13px}th,td{padding:.25em .6em;white-space:nowrap;
border-bottom:1px solid #ddd;text-align:right}
th:first-child,td:first-child,td.text,th.text{text-align:left}tr.bad td{color:#a33}figure{margin:2em 0}
tr.bad td.text:last-of-type{max-width:24em}figcaption{max-width:52em;font-size:14px;color:#444}
th{vertical-align:bottom;font-weight:600;white-space:normal}
tr.bad td.text{white-space:normal}tr.group td{border-top:2px solid #999}
dt{font-weight:600;font-size:14px}dd{margin:0 0 .5em 1.5em;font-size:14px;max-width:52em}
svg{max-width:100%;height:auto}pre{background:#f6f6f6;padding:1em;overflow:auto;font-size:12px}
.wide{overflow-x:auto}"""
#: Rows of the table of differences, and the least difference that has one.
_MOST_DIFFERENCES, _LEAST_SPREAD = 15, 1e-3


def write_report(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a comparison as one HTML page that needs no network.

    Parameters
    ----------
    dataset
        Of ``compare``.
    path
        File to write.

    Raises
    ------
    MpmfwError
        The file cannot be written.
    """
    title = str(dataset.attrs.get("title", "Comparison of contact methods"))
    rows = table(dataset)
    parts = [f"<h1>{escape(title)}</h1>", _reference(dataset), "<h2>Accuracy</h2>"]
    parts.append(_table(dataset, rows, [name for name in _columns(rows) if name not in COSTS]))
    parts += [_differences(dataset), "<h2>Cost</h2>", _table(dataset, rows, COSTS), _notes(dataset.attrs)]
    for name, (figure, caption) in figures_of(dataset).items():
        parts.append(
            f'<figure id="{escape(name)}">{_svg(figure)}<figcaption>{escape(caption)}</figcaption></figure>'
        )
    parts += ["<h2>How it was measured</h2>", _definitions(rows), "<h2>Conditions</h2>", _conditions(dataset)]
    if isinstance(dataset.attrs.get("scene"), str):
        parts.append(
            "<h2>Scene</h2><p>Of the first run; the methods and varied keys of the others take the place of "
            f"its own.</p><pre>{escape(dataset.attrs['scene'])}</pre>"
        )
    page = (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{_STYLE}</style></head><body>{''.join(parts)}</body></html>\n"
    )
    replace_bytes(page.encode("utf-8", "replace"), path)


def _reference(dataset: xr.Dataset) -> str:
    text = described(dataset)
    if text:
        return f"<p>Reference: {escape(text)}.</p>"
    return (
        "<p>No reference is known for this scene: its methods are compared with each other. What each of "
        "them tends to is seen "
        "with smaller cells, <code>--vary grid.cell_size=…</code>; a closed form is named by the scene's "
        "table "
        "<code>[reference]</code>.</p>" + _nothing_touches(dataset)
    )


def _nothing_touches(dataset: xr.Dataset) -> str:
    """What a comparison of contacts without contact is worth."""
    if "contact_force" not in dataset or (np.nan_to_num(dataset["contact_force"].values) != 0.0).any():
        return ""
    return "<p>No two bodies pushed each other in any of the runs: the scene tells nothing about contact.</p>"


def _differences(dataset: xr.Dataset) -> str:
    """The quantities in which the methods differ most, and what the finest cells changed."""
    ranked = [one for one in differences(dataset) if one.spread >= _LEAST_SPREAD]
    labels = [
        f"{contact}, {shape}" for contact in dataset["contact"].values for shape in dataset["shape"].values
    ]
    if len(labels) < 2 or not ranked:
        return ""
    heads = "".join(f"<th>{escape(label)}</th>" for label in labels)
    rows = ""
    for one in ranked[:_MOST_DIFFERENCES]:
        cells = "".join(f"<td>{_number(value)}</td>" for value in one.values.ravel())
        what = f"{escape(one.quantity)}{_unit(one.unit)}"
        rows += f'<tr><td class="text">{what}</td>{cells}<td>{100.0 * one.spread:.3g}</td>'
        rows += f'<td class="text">{escape(one.against)}, {_number(one.scale)}</td></tr>'
    shown = f", the first {_MOST_DIFFERENCES} of {len(ranked)}" if len(ranked) > _MOST_DIFFERENCES else ""
    table = (
        f"<h2>What the methods differ in</h2><p>At the end of the runs, the largest difference first{shown}. "
        "A difference is "
        "the largest value less the least, over what stands beside it.</p>"
        f'<div class="wide"><table><tr><th class="text">Quantity</th>{heads}<th>difference [%]</th>'
        f'<th class="text">of</th></tr>{rows}</table></div>'
    )
    changes = "".join(
        f"<li>{escape(f'{contact}, {shape}')}: {100.0 * change:.3g} % in {escape(quantity)}</li>"
        for (contact, shape), (quantity, change) in refinement(dataset).items()
    )
    return table + (
        f"<p>Largest change from the second finest cells to the finest:</p><ul>{changes}</ul>"
        if changes
        else ""
    )


def _number(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else "–"


def _columns(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    known = [name for name in COLUMNS if any(name in row for row in rows)]
    own = dict.fromkeys(
        name for row in rows for name in row if name.endswith("_error") and name not in COLUMNS
    )
    return [*own, *known]


def _table(dataset: xr.Dataset, rows: Sequence[Mapping[str, Any]], columns: Sequence[str]) -> str:
    labels = [str(dim) for dim in method_dims(dataset)]
    labels += [name for name in CHOICES if any(name in row for row in rows) and name not in labels]
    heads = [f'<th class="text">{escape(label.replace("_", " "))}</th>' for label in [*labels, "status"]]
    heads += [f"<th>{escape(column_of(name).heading)}{_unit(column_of(name).unit)}</th>" for name in columns]
    body, group = [], None
    for row in rows:
        body.append(_row(row, labels, columns, new_group=group is not None and row[labels[0]] != group))
        group = row[labels[0]]
    return f'<div class="wide"><table><tr>{"".join(heads)}</tr>{"".join(body)}</table></div>'


def _unit(unit: str) -> str:
    return "" if unit in ("1", "h") else f" [{escape(unit)}]"


def _row(row: Mapping[str, Any], labels: Sequence[str], columns: Sequence[str], *, new_group: bool) -> str:
    cells = [f'<td class="text">{escape(str(row[name]))}</td>' for name in [*labels, "status"]]
    cells += [f"<td>{escape(shown(row.get(name, float('nan')), column_of(name)))}</td>" for name in columns]
    style = " ".join(["bad"] * (row["status"] != "ok") + ["group"] * new_group)
    return f'<tr class="{style}">{"".join(cells)}</tr>'


def _notes(attributes: Mapping[str, Any]) -> str:
    """What the runs want their reader to know."""
    notes = json.loads(attributes.get("notes", "{}"))
    entries = "".join(
        f"<li>{escape(label.replace('/', ', '))}: {escape('; '.join(text))}</li>"
        for label, text in notes.items()
    )
    return f"<ul>{entries}</ul>" if entries else ""


def _definitions(rows: Sequence[Mapping[str, Any]]) -> str:
    entries = (
        f"<dt>{escape(column_of(name).heading)}</dt><dd>{escape(column_of(name).meaning)}</dd>"
        for name in _columns(rows)
    )
    return f"<dl>{''.join(entries)}</dl><p>A dash stands for what a run did not reach or does not have.</p>"


def _conditions(dataset: xr.Dataset) -> str:
    attributes = dataset.attrs
    versions = attributes.get("versions")
    known = json.loads(versions) if isinstance(versions, str) and versions.startswith("{") else {}
    sentences = []
    if known:
        sentences.append(
            "Computed with " + ", ".join(f"{name} {number}" for name, number in known.items()) + "."
        )
    if "commit" in attributes:
        sentences.append(f"Commit {attributes['commit']}.")
    return f"<p>{escape(' '.join(sentences))}</p>"


def _svg(figure: Figure) -> str:
    """Draw a figure as inline SVG; text stays text, ids do not depend on the time."""
    buffer = io.StringIO()
    with journal_style():
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    return text[text.index("<svg") :]
