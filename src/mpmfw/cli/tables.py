"""Tables that keep every digit: on a narrow terminal or in a pipe they grow downwards, never lose text."""

from __future__ import annotations

import sys
from collections.abc import Collection, Mapping, Sequence
from numbers import Integral
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

#: Narrowest column that words may be wrapped into.
LEAST_WRAPPED = 24


def formatted(value: Any) -> str:
    """Whole numbers and text as they are, other numbers to four digits, nothing for None and NaN."""
    if isinstance(value, bool) or not hasattr(value, "__float__"):
        return "" if value is None else str(value)
    if isinstance(value, Integral):
        return str(int(value))
    number = float(value)
    return "" if number != number else f"{number:.4g}"


def print_rows(rows: Sequence[Mapping[str, Any]], title: str | None = None) -> None:
    """Print rows as a table, its last column wrapped if need be; one that is still too wide as blocks."""
    from rich.console import Console
    from rich.text import Text

    console = Console()
    if not rows:
        return
    keys = list(dict.fromkeys(key for row in rows for key in row))
    cells = [[formatted(row.get(key)) for key in keys] for row in rows]
    widths = [max(len(key), *(len(row[k]) for row in cells)) for k, key in enumerate(keys)]
    # Two spaces after every column, one in front of the table
    spare = console.width - sum(widths) - 2 * len(keys) - 1
    wraps = any(" " in row[-1] for row in cells) and widths[-1] + spare >= LEAST_WRAPPED
    if title:
        console.print(Text(title, style="bold"))
    if spare >= 0 or wraps:
        numeric = [any(hasattr(row.get(key), "__float__") for row in rows) for key in keys]
        console.print(_table(keys, cells, numeric, wrap_last=spare < 0))
    else:
        _print_blocks(console, keys, cells)


def console() -> Console:
    """As wide as the terminal; in a pipe or a file a hundred columns."""
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else 100)


def broken_label(label: str) -> str:
    """A method with options, an option a line."""
    return label.replace(", ", ",\n ") if label.endswith(")") else label


def grouped_table(
    heads: Mapping[str, str],
    rows: Sequence[Mapping[str, str]],
    left: Collection[str],
    title: str | None = None,
    *,
    wrapped: bool = False,
    parted: bool = True,
) -> Table:
    """A table of texts, a line under its heads and nothing around it.

    Parameters
    ----------
    heads
        Of the columns, by the names of the rows' cells.
    rows
        A text for each column; ``style`` is rich's for the row.
    left
        Columns of words; all others stand to the right.
    title
        Above the table.
    wrapped
        Whether the columns of words may be wrapped.
    parted
        Whether rows stand apart where the first column changes.
    """
    from rich import box
    from rich.table import Table
    from rich.text import Text

    plain: dict[str, Any] = {
        "box": box.SIMPLE_HEAD,
        "padding": (0, 1, 0, 0),
        "pad_edge": False,
        "show_edge": False,
    }
    table = Table(title=title, title_justify="left", **plain)
    for name, head in heads.items():
        words = name in left
        table.add_column(
            Text(head),
            justify="left" if words else "right",
            no_wrap=not (words and wrapped),
            overflow="fold",
        )
    first = next(iter(heads))
    for before, row in zip([None, *rows], rows, strict=False):
        if parted and before is not None and before[first] != row[first]:
            table.add_section()
        table.add_row(*(Text(row[name]) for name in heads), style=row.get("style"))
    return table


def _table(keys: list[str], cells: list[list[str]], numeric: list[bool], wrap_last: bool) -> Table:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1), pad_edge=False)
    for k, key in enumerate(keys):
        wrapped = wrap_last and k == len(keys) - 1
        table.add_column(
            Text(key), justify="right" if numeric[k] else "left", no_wrap=not wrapped, overflow="fold"
        )
    for row in cells:
        table.add_row(*(Text(cell) for cell in row))
    return table


def _print_blocks(console: Console, keys: list[str], cells: list[list[str]]) -> None:
    """One block for each row, its first cell as the heading; long text wraps under itself."""
    from rich.table import Table
    from rich.text import Text

    width = max(len(key) for key in keys)
    for row in cells:
        grid = Table.grid(padding=(0, 2))
        grid.add_column(min_width=width, no_wrap=True)
        grid.add_column(overflow="fold")
        for key, cell in zip(keys, row, strict=True):
            if cell:
                grid.add_row(Text(key, style="dim"), Text(cell))
        console.print(grid)
        console.print()
