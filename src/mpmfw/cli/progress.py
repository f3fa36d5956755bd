"""Progress of long work: bars on a terminal, nothing in a pipe."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeAlias

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

#: Called with the simulated time [s] and the number of steps done.
RunReport: TypeAlias = Callable[[float, int], None]
#: Called as ``mpmfw.run``.
Runner: TypeAlias = Callable[..., Any]

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
def compare_progress(total: int, end: float) -> Iterator[Runner | None]:
    """Stand-in for ``mpmfw.run`` that shows how far ``total`` runs to ``end`` [s] are; None in a pipe."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (
        TextColumn("{task.fields[started]}/{task.fields[runs]} {task.description}, {task.fields[done]}"),
        BarColumn(),
        TextColumn("{task.fields[time]:.4g} s simulated"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=total * end, started=0, runs=total, done=PREPARING, time=0.0)
        started = 0

        def runner(scene: Any, **arguments: Any) -> Any:
            nonlocal started
            from mpmfw.runs import run

            done, started = started * end, started + 1
            label = ", ".join(_label(arguments.get(kind)) for kind in ("contact", "shape"))
            bar.update(task, completed=done, description=label, started=started, done=PREPARING, time=0.0)

            def report(time: float, steps: int) -> None:
                bar.update(task, completed=done + min(time, end), done=f"{steps} steps", time=time)

            return run(scene, **{**arguments, "progress": report})

        yield runner


def _label(method: Any) -> str:
    return str(getattr(method, "label", method))
