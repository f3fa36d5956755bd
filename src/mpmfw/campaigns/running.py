"""Run the missing part of a campaign: first the results, then the repeats that measure their cost."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, TypedDict

from mpmfw.campaigns.executors import Executor, InProcess
from mpmfw.campaigns.store import Cost, Finished, Outcome, Store
from mpmfw.campaigns.work import Task, run_once, time_once
from mpmfw.errors import Interrupted, SceneError, is_complete, status_code
from mpmfw.runs.interruption import interruptible


@dataclass(frozen=True)
class Event:
    """The progress of a campaign."""

    done: int  #: runs that ended since this start, repeats included
    total: int  #: runs of this start
    name: str = ""  #: of the run that has just ended; empty at the start, and where repeats begin
    status: str = ""  #: of that run
    next: str = ""  #: the run that begins now, if runs follow each other in this process


Progress = Callable[[Event], None]


def do(
    work: Callable[[Any], Finished],
    tasks: Iterable[Any],
    store: Store,
    executor: Executor,
    progress: Progress | None = None,
) -> None:
    """Do the tasks (each with a ``key`` and a ``name``) that the store lacks, and store each when it ends."""
    missing = [task for task in tasks if store.outcome(task.key) is None]
    _do(work, missing, store, executor, _Counter(progress, len(missing)))


def complete(
    tasks: Mapping[str, Task],
    store: Store,
    executor: Executor,
    repeats: int = 1,
    exclusive: bool = False,
    progress: Progress | None = None,
    run_progress: Callable[[float, int], None] | None = None,
) -> None:
    """Run the results and repeats that the store lacks, and store each when it ends.

    Each run gets ``repeats`` costs; ``exclusive`` ones are measured one at a time after all results.
    """

    def lacking(key: str) -> int:
        outcome = store.outcome(key)
        if outcome is None or not is_complete(outcome.status):
            return 0  # a failed one needs no more
        return max(0, repeats - len(counted(outcome, exclusive)))

    missing = [
        task
        for key, task in tasks.items()
        if (known := store.outcome(key)) is None or (task.force and status_code(known.status) == "refused")
    ]  # a refusal of what is forced now
    timer: Executor = InProcess() if exclusive else executor
    # A result gives a cost as well, unless that one does not count
    for_free = executor.timing == "exclusive" or not exclusive
    left = repeats - (1 if for_free else 0)
    count = _Counter(progress, len(missing) * (1 + left) + sum(lacking(key) for key in tasks))

    def work(task: Task) -> Finished:
        return run_once(task, run_progress)

    once = work if run_progress is not None and isinstance(executor, InProcess) else run_once
    _do(once, [replace(task, timing=executor.timing) for task in missing], store, executor, count, left)
    # In rounds, so that all share an hour of a slow machine
    times = {key: lacking(key) for key in tasks}
    rounds = range(max(times.values(), default=0))
    again = [replace(tasks[key], timing=timer.timing) for k in rounds for key, n in times.items() if n > k]
    count.total = count.done + len(again)
    if again:
        count.coming = _names(again, timer)
        count.tell()
    for task, finished in timer.outcomes(time_once, again):
        known = store.outcome(task.key)
        if known is not None:
            store.put(_with_repeat(known, finished))
        count(task.name, "repeat")


def _do(
    work: Callable[[Any], Finished],
    tasks: list[Any],
    store: Store,
    executor: Executor,
    count: _Counter,
    repeats_left: int = 0,
) -> None:
    count.coming = _names(tasks, executor)
    count.tell()
    for task, finished in executor.outcomes(work, tasks):
        if finished is None:
            text = "failed: its process ended abruptly, perhaps because memory ran out"
            finished = Finished(Outcome(task.key, text, task.name, lasting=False))
        store.put(finished.outcome, finished.results)
        count.total -= 0 if is_complete(finished.outcome.status) else repeats_left
        count(task.name, finished.outcome.status)


def _names(tasks: Iterable[Any], executor: Executor) -> Iterator[str]:
    """Return the names of runs in their order, if they run one after the other."""
    return iter([task.name for task in tasks] if isinstance(executor, InProcess) else ())


def counted(outcome: Outcome | None, exclusive: bool) -> list[Cost]:
    """Return the costs that count."""
    costs = [] if outcome is None else list(outcome.costs)
    return [cost for cost in costs if cost.timing == "exclusive"] if exclusive else costs


def _with_repeat(known: Outcome, finished: Finished | None) -> Outcome:
    if finished is None or not finished.outcome.costs or not is_complete(finished.outcome.status):
        why = "its process ended abruptly" if finished is None else finished.outcome.status
        return _noted(known, f"a repeat that measures the cost ended differently: {why}")
    longer = replace(known, costs=(*known.costs, finished.outcome.costs[0]))
    if finished.outcome.digest == known.digest:
        return longer
    return _noted(
        longer, "a repeat, perhaps on another machine, gave series that differ from the stored ones"
    )


def _noted(outcome: Outcome, note: str) -> Outcome:
    return replace(outcome, notes=tuple(dict.fromkeys((*outcome.notes, note))))


@contextmanager
def resumable(store: Store, what: str) -> Iterator[None]:
    """Context in which the message of an interruption says how to continue."""
    with interruptible():
        try:
            yield
        except KeyboardInterrupt as error:
            text = "nothing is kept"
            if store.lasts:
                kept = len(list(store.folder.glob("[!.]*.json")))
                text = f"{store.folder} keeps {kept} finished runs; the same {what} continues from them"
            raise Interrupted(getattr(error, "number", signal.SIGINT), f"interrupted: {text}") from None


class _Counter:
    """Counts and reports finished runs."""

    def __init__(self, progress: Progress | None, total: int) -> None:
        self.done, self.total, self.progress = 0, total, progress
        self.coming: Iterator[str] = iter(())  #: names of the runs that have not begun

    def __call__(self, name: str, status: str) -> None:
        """Count one more run."""
        self.done += 1
        self.tell(name, status)

    def tell(self, name: str = "", status: str = "") -> None:
        """Report the progress."""
        if self.progress is not None:
            self.progress(Event(self.done, self.total, name, status, next(self.coming, "")))


class Running(TypedDict, total=False):
    """Keywords of :func:`mpmfw.campaign` and the like."""

    executor: Any
    jobs: int | None
    store: str | os.PathLike[str] | None
    repeats: int | None
    force: bool
    progress: Progress | None
    run_progress: Callable[[float, int], None] | None


@dataclass(frozen=True)
class Execution:
    """How runs are executed.

    Functions that take these keywords raise MpmfwError if a file cannot be written, and Interrupted at Ctrl-C
    or SIGTERM; the store then has the finished runs.
    """

    #: an executor of ``concurrent.futures``, a ``Client`` or cluster of ``dask.distributed``, or the address
    #: of its scheduler
    executor: Any = None
    jobs: int | None = 1  #: single-threaded processes; 1 is this process, None one for each core
    #: folder of finished runs, which a campaign reuses; without it nothing is kept
    store: str | os.PathLike[str] | None = None
    repeats: int | None = None  #: runs of each point, the cheapest counts; by default 1, or the study's
    force: bool = False  #: whether runs may be past the limits of steps and frames
    progress: Progress | None = None  #: called after every run
    run_progress: Callable[[float, int], None] | None = None  #: called within runs in this process

    def __post_init__(self) -> None:
        repeats: Any = self.repeats  # a caller may give anything
        if repeats is not None and not (isinstance(repeats, int) and repeats >= 1):
            raise SceneError(f"repeats: must be at least 1, not {repeats!r}")
