"""Measured costs as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich.table import Table

#: Columns with two digits behind the point.
_RATIOS = ("ratio", "ratio_low", "ratio_high")


def table(rows: Sequence[Mapping[str, Any]], title: str = "ns per material point and step") -> Table:
    """Rows as :func:`measure_scene` makes them, a column for each key."""
    made = Table(title=title)
    keys = list(dict.fromkeys(key for row in rows for key in row))
    for key in keys:
        numeric = any(isinstance(row.get(key), int | float) for row in rows)
        made.add_column(_heading(key), justify="right" if numeric else "left", no_wrap=True)
    for row in rows:
        made.add_row(*[_formatted(key, row.get(key)) for key in keys])
    return made


def _heading(key: str) -> str:
    """Column heading; the stage that fills the table of the shape function is no second column called
    shape.
    """
    return "fill" if key == "ns_shape" else key.removeprefix("ns_").replace("_", " ")


def _formatted(key: str, value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.2f}" if key in _RATIOS else f"{value:.1f}"
    return str(value)
