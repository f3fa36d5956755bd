"""Where runs take place: here, in a pool of processes, or on a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import connection
from typing import Protocol, TypeAlias

from mpmfw.studies.work import Finished, Task

Work: TypeAlias = Callable[[Task], Finished]

#: What came of a task; None if the process that ran it died.
Outcome: TypeAlias = tuple[Task, Finished | None]

_THREADS = (
    "NUMBA_NUM_THREADS",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)


class Executor(Protocol):
    """Runs tasks in any order.

    Attributes
    ----------
    timing
        How costs that it measures are marked: ``exclusive`` if it runs one task at a time.
    """

    timing: str

    def outcomes(self, work: Work, tasks: Sequence[Task]) -> Iterator[Outcome]:
        """Do all tasks and yield each as it is done."""


class InProcess:
    """One task after the other, in this process."""

    timing = "exclusive"

    def outcomes(self, work: Work, tasks: Sequence[Task]) -> Iterator[Outcome]:
        """Do all tasks in their order."""
        for task in tasks:
            yield task, work(task)


class Pool:
    """Processes of one thread each, started afresh.

    Parameters
    ----------
    jobs
        Processes at a time; None is one for each core that this process may use.
    """

    def __init__(self, jobs: int | None = None) -> None:
        self.jobs = jobs or cores()
        self.timing = "exclusive" if self.jobs == 1 else "shared cores"

    def outcomes(self, work: Work, tasks: Sequence[Task]) -> Iterator[Outcome]:
        """Do all tasks; those whose process may have died are done again, each alone, before they are given up."""
        waiting = deque(tasks)
        suspects: list[Task] = []
        with _one_thread():
            while waiting:
                yield from _until_broken(work, waiting, suspects, self.jobs)
            alone, dead = deque(suspects), list[Task]()
            while alone:
                yield from _until_broken(work, alone, dead, 1)
            for task in dead:
                yield task, None


def _until_broken(work: Work, waiting: deque[Task], suspects: list[Task], jobs: int) -> Iterator[Outcome]:
    """Do the tasks that wait; if a process dies, all that were under way become suspects."""
    # Started afresh, not forked: threads of this process's libraries do not survive a fork
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(min(jobs, len(waiting)), mp_context=context, initializer=_end_with_parent)
    under_way: dict[Future[Finished], Task] = {}
    try:
        while waiting or under_way:
            while waiting and len(under_way) < jobs:
                task = waiting.popleft()
                under_way[pool.submit(work, task)] = task
            done, _ = wait(under_way, return_when=FIRST_COMPLETED)
            for future in done:
                try:
                    finished = future.result()
                except BrokenProcessPool:
                    suspects.extend(under_way.values())
                    return
                yield under_way.pop(future), finished
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _end_with_parent() -> None:
    """End this worker when its parent dies: nobody would take what it is doing, and it would wait for ever."""
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            connection.wait([parent.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def cores() -> int:
    """Cores that this process may use."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed is not None else os.cpu_count() or 1


@contextmanager
def _one_thread() -> Iterator[None]:
    """Processes that are started inside use one thread each; libraries read this when they are loaded."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
