"""Where runs take place: here, in a pool of processes, in anybody's ``concurrent.futures.Executor``, or on a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Future,
    ProcessPoolExecutor,
    as_completed,
    wait,
)
from concurrent.futures import Executor as FuturesExecutor
from contextlib import contextmanager
from multiprocessing import connection
from typing import Any, Protocol, TypeVar

from mpmfw.errors import SceneError

T = TypeVar("T")
R = TypeVar("R")

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
    cores
        Tasks at a time, in words.
    """

    timing: str
    cores: str

    def outcomes(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | None]]:
        """Do all tasks and yield each as it is done, with None where the process that did it died."""


def executor_of(executor: Any = None, jobs: int | None = None) -> Executor:
    """What runs tasks, for what a request names.

    Parameters
    ----------
    executor
        An :class:`Executor`, a ``concurrent.futures.Executor``, a ``Client`` or cluster of ``dask.distributed``, or the
        address of its scheduler, such as ``tcp://127.0.0.1:8786``.
    jobs
        Processes at a time without an executor: 1 is this process itself, None one for each core.

    Raises
    ------
    SceneError
        It is none of these, or both are given.
    """
    if executor is not None and jobs is not None:
        raise SceneError("jobs: has no effect with an executor, whose workers are as many as they are")
    if executor is None:
        if jobs is not None and jobs < 1:
            raise SceneError(f"jobs: must be at least 1, not {jobs}")
        return InProcess() if (jobs or cores()) == 1 else Pool(jobs)
    if isinstance(executor, FuturesExecutor):
        return Futures(executor)
    if isinstance(executor, str) or hasattr(executor, "scheduler_info") or hasattr(executor, "get_client"):
        from mpmfw.campaigns.cluster import Cluster

        return Cluster(executor)
    if hasattr(executor, "outcomes"):
        return executor  # type: ignore[no-any-return]
    raise SceneError(
        f"executor: {executor!r} is none; expected a concurrent.futures.Executor, a Client or cluster of dask.distributed, "
        "or the address of its scheduler"
    )


class InProcess:
    """One task after the other, in this process."""

    timing = "exclusive"
    cores = "one core"

    def outcomes(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | None]]:
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
        self.cores = "one core" if self.jobs == 1 else f"{self.jobs} processes on {cores()} cores"

    def outcomes(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | None]]:
        """Do all tasks; those whose process may have died are done again, each alone, before they are given up.

        What cannot leave this process, such as the object of a notebook's class, is done here at the end.
        """
        waiting = deque(task for task in tasks if _leaves(task))
        here = [task for task in tasks if not _leaves(task)]
        suspects: list[T] = []
        with _one_thread():
            while waiting:
                yield from _until_broken(work, waiting, suspects, self.jobs)
            alone, dead = deque(suspects), list[T]()
            while alone:
                yield from _until_broken(work, alone, dead, 1)
            for task in dead:
                yield task, None
        yield from InProcess().outcomes(work, here)


def _leaves(task: Any) -> bool:
    """Whether a task can be sent to another process."""
    try:
        pickle.dumps(task)
    except Exception:
        return False
    return True


class Futures:
    """Anybody's executor, such as a pool of MPI processes.

    Parameters
    ----------
    executor
        It is used and not shut down.
    """

    timing = "shared cores"

    def __init__(self, executor: FuturesExecutor) -> None:
        self.executor = executor
        self.cores = f"the workers of a {type(executor).__name__}"

    def outcomes(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | None]]:
        """Do all tasks; what is left when the executor breaks is done in processes of our own, each alone."""
        waiting = deque(tasks)
        under_way: dict[Future[R], T] = {}
        try:
            while waiting:
                under_way[self.executor.submit(work, waiting[0])] = waiting[0]
                waiting.popleft()
            for future in as_completed(list(under_way)):
                result = future.result()
                yield under_way.pop(future), result
        except BrokenExecutor:
            left = [*under_way.values(), *waiting]
            under_way.clear()
            yield from Pool(1).outcomes(work, left)
        finally:
            for future in under_way:
                future.cancel()


def _until_broken(
    work: Callable[[T], R], waiting: deque[T], suspects: list[T], jobs: int
) -> Iterator[tuple[T, R | None]]:
    """Do the tasks that wait; if a process dies, all that were under way become suspects."""
    # Started afresh, not forked: threads of this process's libraries do not survive a fork
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(min(jobs, len(waiting)), mp_context=context, initializer=_begin_worker)
    under_way: dict[Future[R], T] = {}
    try:
        while waiting or under_way:
            while waiting and len(under_way) < jobs:
                task = waiting.popleft()
                try:
                    under_way[pool.submit(work, task)] = task
                except BrokenExecutor:
                    suspects.extend((task, *under_way.values()))
                    return
            done, _ = wait(under_way, return_when=FIRST_COMPLETED)
            for future in done:
                try:
                    finished = future.result()
                except BrokenExecutor:
                    suspects.extend(under_way.values())
                    return
                yield under_way.pop(future), finished
    finally:
        if under_way:  # an interruption: nobody would take what they are doing
            for process in list((getattr(pool, "_processes", None) or {}).values()):
                process.kill()
        pool.shutdown(wait=False, cancel_futures=True)


def _begin_worker() -> None:
    """Leave Ctrl-C to the parent, and end this worker when its parent dies: nobody would take what it is doing."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
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
