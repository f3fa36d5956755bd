"""Progress of long work: bars on a terminal, nothing in a pipe."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from mpmfw.campaigns.running import Event

#: Called with the simulated time [s] and the number of steps done.
RunReport: TypeAlias = Callable[[float, int], None]

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
def run_progress(end: float) -> Iterator[RunReport | None]:
    """Context with the report of one run until ``end`` [s]."""
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
