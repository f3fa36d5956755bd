"""Do what a study still lacks: first the results, then the repeats that make the cost known."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from mpmfw.scene import Scene
from mpmfw.studies.executors import Executor, InProcess
from mpmfw.studies.grid import Grid
from mpmfw.studies.identity import code_of, key_of
from mpmfw.studies.store import Cost, Record, Store
from mpmfw.studies.work import Finished, Task, run_once, time_once


@dataclass(frozen=True)
class Event:
    """How far a study is.

    Attributes
    ----------
    done, total
        Runs of this start, repeats included; what was finished before is not counted.
    name, status
        Of the run that has just ended; empty at the start.
    """

    done: int
    total: int
    name: str = ""
    status: str = ""


Progress = Callable[[Event], None]


@dataclass(frozen=True)
class Wanted:
    """A different run of a study.

    Attributes
    ----------
    key, name
        As in its record; the name is that of the first combination that needs it.
    scene
        What runs.
    """

    key: str
    name: str
    scene: Scene

    def task(self, timing: str) -> Task:
        """The run as a task."""
        return Task(self.key, self.name, self.scene, code_of(self.scene), timing)


def wanted(grid: Grid) -> dict[str, Wanted]:
    """The different runs of a grid by key; combinations that differ in nothing share one."""
    found: dict[str, Wanted] = {}
    for one in grid.combinations.values():
        if one.scene is not None:
            key = key_of(one.scene)
            found.setdefault(key, Wanted(key, one.name, one.scene))
    return found


def complete(
    runs: Mapping[str, Wanted],
    store: Store,
    executor: Executor,
    repeats: int,
    exclusive: bool,
    progress: Progress | None = None,
) -> None:
    """Run what the store lacks and keep each as it ends.

    Parameters
    ----------
    runs
        Of :func:`wanted`.
    store
        Where finished runs are.
    executor
        Where results are made, and costs if they need not be exclusive.
    repeats
        Costs that each run is to have.
    exclusive
        Whether costs have to be measured one at a time, in this process, after all results are there.
    progress
        Called at the start and after every run.
    """
    missing = [one for key, one in runs.items() if store.record(key) is None]
    timer: Executor = InProcess() if exclusive else executor
    # A result gives a cost as well, unless that one does not count
    for_free = executor.timing == "exclusive" or not exclusive
    repeats_left = repeats - 1 if for_free else repeats
    count = _Counter(progress)
    lacking = sum(_lacking(store.record(key), repeats, exclusive) for key in runs)
    count.total = len(missing) * (1 + repeats_left) + lacking
    count.tell()
    for task, finished in executor.outcomes(run_once, [one.task(executor.timing) for one in missing]):
        ended = finished if finished is not None else Finished(_dead(task))
        store.put(ended.record, ended.results)
        count.total -= 0 if ended.record.status == "ok" else repeats_left
        count(task.name, ended.record.status)
    again = [one for key, one in runs.items() for _ in range(_lacking(store.record(key), repeats, exclusive))]
    count.total = count.done + len(again)
    for task, finished in timer.outcomes(time_once, [one.task(timer.timing) for one in again]):
        known = store.record(task.key)
        if finished is not None and known is not None and finished.record.costs:
            store.put(_with_repeat(known, finished.record))
        count(task.name, "repeat")


def _lacking(record: Record | None, repeats: int, exclusive: bool) -> int:
    """Costs that a run still lacks; a failed one needs no more."""
    if record is None or record.status != "ok":
        return 0
    return max(0, repeats - len(counted(record, exclusive)))


def counted(record: Record | None, exclusive: bool) -> list[Cost]:
    """The costs of a run that count: the exclusive ones where asked for, else all."""
    costs = [] if record is None else list(record.costs)
    return [cost for cost in costs if cost.timing == "exclusive"] if exclusive else costs


def _dead(task: Task) -> Record:
    return Record(
        task.key, "failed: its process ended abruptly, perhaps for want of memory", task.name, lasting=False
    )


def _with_repeat(known: Record, repeat: Record) -> Record:
    """The record with one cost more; numbers that differ from the stored ones are a note."""
    longer = replace(known, costs=(*known.costs, repeat.costs[0]))
    if repeat.digest == known.digest:
        return longer
    note = "a repeat, perhaps on another machine, gave series that differ from the stored ones"
    return replace(longer, notes=tuple(dict.fromkeys((*known.notes, note))))


class _Counter:
    """Tells how many runs are done."""

    def __init__(self, progress: Progress | None) -> None:
        self.done, self.total, self.progress = 0, 0, progress

    def __call__(self, name: str, status: str) -> None:
        """One run more has ended."""
        self.done += 1
        self.tell(name, status)

    def tell(self, name: str = "", status: str = "") -> None:
        """Report where the study is."""
        if self.progress is not None:
            self.progress(Event(self.done, self.total, name, status))
