"""Tables for other programs: CSV and JSON on standard output, all digits, and everything else on standard error."""

from __future__ import annotations

import csv
import json
import math
import sys
from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Annotated, Any, TypeAlias

import typer


class Format(StrEnum):
    """How a table is printed."""

    table = "table"
    csv = "csv"
    json = "json"


FormatOption: TypeAlias = Annotated[
    Format,
    typer.Option(
        "--format", help="How the table is printed; csv and json have all digits and nothing beside it."
    ),
]


def write_rows(rows: Sequence[Mapping[str, Any]], form: Format) -> None:
    """Print rows as CSV, empty where a value is not known, or as JSON, null there."""
    plain = [{key: _plain(value) for key, value in row.items()} for row in rows]
    if form is Format.json:
        print(json.dumps(plain, indent=1, ensure_ascii=False))
        return
    keys = list(dict.fromkeys(key for row in plain for key in row))
    writer = csv.DictWriter(sys.stdout, keys, lineterminator="\n")
    writer.writeheader()
    writer.writerows(plain)


def _plain(value: Any) -> Any:
    """A value that JSON knows; None for a number that is none."""
    if isinstance(value, str | bool | int) or value is None:
        return value
    if hasattr(value, "item"):
        return _plain(value.item())
    number = float(value)
    return number if math.isfinite(number) else None
