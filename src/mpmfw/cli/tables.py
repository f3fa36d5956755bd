"""Tables and progress on a terminal; for other programs tables as CSV or JSON, and no progress."""

from __future__ import annotations

import csv
import functools
import json
import math
import sys
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from typer import Option

if TYPE_CHECKING:
    from mpmfw.campaigns.running import Event


#: Width of a wrapped column of words.
_WRAPPED = 24


Format = StrEnum("Format", ("text", "csv", "json"))

FormatOption: TypeAlias = Annotated[
    Format, Option("--format", help="Form of the table; csv and json have all digits.")
]


def formatted(value: Any) -> str:
    """Return a cell: numbers to four digits, a dash for NaN, nothing for None."""
    if isinstance(value, bool) or not hasattr(value, "__float__"):
        return "" if value is None else str(value)
    if hasattr(value, "__index__"):
        return str(int(value))
    number = float(value)
    return "–" if math.isnan(number) else f"{number:.4g}"


def print_table(
    rows: Sequence[Mapping[str, Any]],
    heads: Mapping[str, str] | None = None,
    *,
    labels: Collection[str],
    words: Collection[str] = (),
    title: str = "",
) -> None:
    """Print rows as a table, or as several if there are too many columns.

    ``heads`` gives columns in order; those without a value are left out. Labels and ``words`` are wrapped.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console()
    names = heads or {name: name for row in rows for name in row if name != "style"}
    cells = {name: [formatted(row.get(name)) for row in rows] for name in names}
    known = [name for name in names if name in labels or set(cells[name]) - {"", "–"}]
    half, heading = console.width // 2, [name for name in known if name in labels]

    def table_of(columns: Sequence[str]) -> Table:
        table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False, show_edge=False)
        shown = [name for name in known if name in heading or name in columns]
        for name in shown:
            text = name in heading or name in words
            room = _WRAPPED if name in words else half // len(heading)
            longest = max(map(len, " ".join([names[name], *cells[name]]).split()), default=0)
            table.add_column(
                Text(names[name]),
                justify="left" if text else "right",
                max_width=min(max(room, longest), half) if text else None,
                no_wrap=not text,
                overflow="fold",
            )
        first = cells[shown[0]]
        for k, row in enumerate(rows):
            if k and len(labels) > 1 and first[k] != first[k - 1]:
                table.add_section()
            table.add_row(*(Text(cells[name][k]) for name in shown), style=row.get("style"))
        return table

    if title:
        console.print(Text(title, style="bold"))
    wide = console.options.update_width(10_000)
    left = [name for name in known if name not in heading]
    while True:
        count = len(left)
        while count > 1 and console.measure(table_of(left[:count]), options=wide).maximum > console.width:
            count -= 1
        console.print(table_of(left[:count]))
        console.print()
        left = left[count:]
        if not left:
            return


def write_rows(rows: Sequence[Mapping[str, Any]], form: Format) -> None:
    """Print rows as CSV or JSON; unknown values are empty or null."""
    plain = [{key: _plain(value) for key, value in row.items()} for row in rows]
    if form is Format.json:
        print(json.dumps(plain, indent=1, ensure_ascii=False))
        return
    keys = list(dict.fromkeys(key for row in plain for key in row))
    writer = csv.DictWriter(sys.stdout, keys, lineterminator="\n")
    writer.writeheader()
    writer.writerows(plain)


def _plain(value: Any) -> Any:
    value = value.item() if hasattr(value, "item") else value
    return None if isinstance(value, float) and not math.isfinite(value) else value


#: Shown before the first step of a run.
PREPARING = "compiling, settling"


@contextmanager
def _bar(*columns: str, total: float | None = None, **fields: Any) -> Iterator[Callable[..., None] | None]:
    """Context with a function that updates a bar of these columns; None without a terminal."""
    from rich import progress
    from rich.console import Console

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    shown = [getattr(progress, name)() if name.endswith("Column") else name for name in columns]
    with progress.Progress(*shown, console=console, transient=True) as bar:
        yield functools.partial(bar.update, bar.add_task(PREPARING, total=total, **fields))


@contextmanager
def run_progress(end: float) -> Iterator[Callable[[float, int], None] | None]:
    """Context with the report of one run until ``end`` [s]: of the simulated time [s] and of steps done."""
    simulated = "{task.completed:.4g} of {task.total:.4g} s simulated"
    columns = ("BarColumn", simulated, "TimeElapsedColumn", "left", "TimeRemainingColumn")
    with _bar("{task.description}", *columns, total=end) as update:
        yield update and (lambda time, steps: update(completed=time, description=f"{steps} steps"))


@contextmanager
def outputs_progress(doing: str) -> Iterator[Callable[[int, int], None] | None]:
    """Context with the report of outputs that are done."""
    with _bar(doing, "BarColumn", "MofNCompleteColumn", "left", "TimeRemainingColumn") as update:
        yield update and (lambda done, total: update(completed=done, total=total))


@contextmanager
def campaign_progress(what: str = "runs") -> Iterator[dict[str, Any]]:
    """Context with a campaign's keywords ``progress`` and ``run_progress``; None in a pipe."""
    counts = (what, "BarColumn", "MofNCompleteColumn", "TimeElapsedColumn", "left", "TimeRemainingColumn")
    with _bar(*counts, "{task.description}", "{task.fields[inner]}", inner="") as update:
        if update is None:
            yield {"progress": None, "run_progress": None}
            return

        def tell(event: Event) -> None:
            ended = f"last: {event.name}, {event.status.partition(':')[0]}" if event.name else PREPARING
            text, inner = (event.next, PREPARING) if event.next else (ended, "")
            update(completed=event.done, total=event.total, description=text, inner=inner)

        def within(time: float, steps: int) -> None:
            update(inner=f"{steps} steps, {time:.4g} s simulated")

        yield {"progress": tell, "run_progress": within}
