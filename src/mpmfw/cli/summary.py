"""A comparison on a terminal: one line a method, columns that do not fit below, reasons under the table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from mpmfw.cli.tables import broken_label, grouped_table

if TYPE_CHECKING:
    import xarray as xr

#: Columns of the page that a terminal does without.
_LEFT_OUT = {"largest_penetration", "material_points", "steps"}


def print_comparison(dataset: xr.Dataset) -> None:
    """Print the table of a comparison, as wide as the terminal allows, and why runs failed."""
    from mpmfw.report import CHOICES, COLUMNS, method_dims, shown, table
    from mpmfw.report.columns import column_of
    from mpmfw.report.table import measured as own_errors
    from mpmfw.results.references import described

    console, rows = Console(), table(dataset)
    labels = [str(dim) for dim in method_dims(dataset)]
    chosen = [name for name in CHOICES if name not in labels and any(row.get(name) for row in rows)]
    broken = [row["status"] != "ok" for row in rows]
    if any(broken):
        chosen.insert(0, "status")
    measured = own_errors(dataset) + [
        name for name in COLUMNS if name not in _LEFT_OUT and any(name in row for row in rows)
    ]
    heads = {name: (column_of(name).short, _unit(column_of(name).unit)) for name in measured}
    heads = {**{label: (label.replace("_", " "), "") for label in (*labels, *chosen)}, **heads}
    wide = sum(max(len(str(row[label])) for row in rows) + 2 for label in labels) > console.width // 3
    cells = [
        {
            **{label: broken_label(str(row[label])) if wide else str(row[label]) for label in labels},
            **{name: row.get(name, "") for name in chosen},
            "status": str(row["status"]).partition(":")[0] if bad else "",
            **{name: shown(row.get(name, float("nan")), column_of(name)) for name in measured},
            "style": "red" if bad else "",
        }
        for row, bad in zip(rows, broken, strict=True)
    ]
    titles = {name: "\n".join(part for part in head if part) for name, head in heads.items()}
    words = {*labels, *chosen}
    for columns in _portions(heads, labels, cells, console.width):
        console.print(grouped_table({name: titles[name] for name in (*labels, *columns)}, cells, words))
        console.print()
    for row in rows:
        if row["status"] != "ok":
            console.print(Text(f"{', '.join(str(row[label]) for label in labels)}: {row['status']}"))
    reference = described(dataset)
    if reference:
        own = reference.startswith("each row")
        console.print(Text(f"Errors: {reference}" if own else f"Errors against {reference}", style="dim"))


def _unit(unit: str) -> str:
    return "" if unit == "1" else f"[{unit}]"


def _portions(
    heads: Mapping[str, tuple[str, str]],
    labels: Sequence[str],
    cells: Sequence[Mapping[str, str]],
    width: int,
) -> list[list[str]]:
    """Share the measures out to tables that fit: two spaces after every column."""
    wide = {
        name: max(len(line) for text in (*head, *(row[name] for row in cells)) for line in text.split("\n"))
        + 2
        for name, head in heads.items()
    }
    room = width - sum(wide[label] for label in labels)
    portions: list[list[str]] = [[]]
    for name in (name for name in heads if name not in labels):
        if portions[-1] and sum(wide[one] for one in portions[-1]) + wide[name] > room:
            portions.append([])
        portions[-1].append(name)
    return portions
