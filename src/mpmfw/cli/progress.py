"""Progress of long work: bars on a terminal, nothing in a pipe."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeAlias

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

if TYPE_CHECKING:
    from mpmfw.campaigns.running import Event

#: Called with the simulated time [s] and the number of steps done.
RunReport: TypeAlias = Callable[[float, int], None]

#: What a run does before its first step.
PREPARING = "compiling, settling"


@contextmanager
def run_progress(end: float) -> Iterator[RunReport | None]:
    """Report of one run until ``end`` [s]: steps, simulated time, time left; None without a terminal."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (
        TextColumn("{task.fields[done]}"),
        BarColumn(),
        TextColumn("{task.completed:.4g} of {task.total:.4g} s simulated"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("run", total=end, done=PREPARING)
        yield lambda time, steps: bar.update(task, completed=time, done=f"{steps} steps")


@contextmanager
def campaign_progress(
    what: str = "runs",
) -> Iterator[tuple[Callable[[Event], None] | None, RunReport | None]]:
    """How many runs of a campaign are done, and how far the one is that runs in this process; None in a pipe."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield None, None
        return
    columns = (TextColumn(what), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("left"))
    last = (TimeRemainingColumn(), TextColumn("{task.description}"), TextColumn("{task.fields[inner]}"))
    with Progress(*columns, *last, console=console, transient=True) as bar:
        task = bar.add_task(PREPARING, total=None, inner="")

        def tell(event: Event) -> None:
            said = f"{event.name}: {event.status.partition(':')[0]}" if event.name else PREPARING
            bar.update(task, completed=event.done, total=event.total, description=said, inner="")

        yield tell, lambda time, steps: bar.update(task, inner=f"{steps} steps, {time:.4g} s simulated")
