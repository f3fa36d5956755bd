"""Executors: this process, a pool, any ``concurrent.futures.Executor``, or a Dask cluster."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import pickle
import signal
import socket
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Future,
    ProcessPoolExecutor,
    as_completed,
    wait,
)
from concurrent.futures import Executor as FuturesExecutor
from contextlib import AbstractContextManager, contextmanager, nullcontext
from multiprocessing import connection
from typing import Any, Protocol, TypeVar
from unittest import mock

from mpmfw.errors import MpmfwError, SceneError
from mpmfw.runs.interruption import unbroken
from mpmfw.runs.limits import cores

T = TypeVar("T")
R = TypeVar("R")

ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("NUMBA", "OMP", "OPENBLAS", "MKL")}
ONE_THREAD |= {"VECLIB_MAXIMUM_THREADS": "1"}

#: Seconds to wait for the scheduler of a Dask cluster to answer.
PATIENCE = 10.0


class Executor(Protocol):
    """Runs tasks in any order."""

    timing: str  #: how costs that it measures are marked: ``exclusive`` if it runs one task at a time
    cores: str  #: tasks at a time, in words

    def outcomes(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | None]]:
        """Run all tasks and yield each with its outcome, or with None if its process died."""


class InProcess:
    """Runs one task after the other, in this process."""

    timing = "exclusive"
    cores = "one core"

    def outcomes(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | None]]:
        """Run all tasks in their order."""
        for task in tasks:
            yield task, work(task)


class Pool:
    """Pool of single-threaded processes, by default one for each core; if one dies, the others continue."""

    def __init__(self, jobs: int | None = None) -> None:
        self.jobs = jobs or cores()
        self.timing = "exclusive" if self.jobs == 1 else "shared cores"
        self.cores = "one core" if self.jobs == 1 else f"{self.jobs} processes on {cores()} cores"

    def outcomes(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | None]]:
        """Run all tasks; repeat one by one those whose process died; run those here that cannot be
        pickled."""
        leaving, here, died, dead = (deque[T]() for _ in range(4))
        for task in tasks:
            (leaving if _leaves(task) else here).append(task)
        with mock.patch.dict(os.environ, ONE_THREAD):
            yield from self._done(work, leaving, self.jobs, died)
            yield from self._done(work, died, 1, dead)
        for task in dead:
            yield task, None
        yield from InProcess().outcomes(work, here)

    def _done(
        self, work: Callable[[T], R], waiting: deque[T], jobs: int, died: deque[T]
    ) -> Iterator[tuple[T, R]]:
        """Run tasks, some at a time; add those whose process died to ``died``."""
        context = multiprocessing.get_context("spawn")  # threads do not survive a fork
        idle: list[ProcessPoolExecutor] = []
        under_way: dict[Future[R], tuple[T, ProcessPoolExecutor]] = {}
        try:
            while waiting or under_way:
                while waiting and len(under_way) < jobs:
                    process = idle.pop() if idle else ProcessPoolExecutor(1, context, _begin_worker)
                    try:
                        with unbroken():  # a process whose start is broken off complains
                            under_way[process.submit(work, waiting[0])] = waiting[0], process
                    except BrokenExecutor:  # it died while idle
                        continue
                    waiting.popleft()
                done, _ = wait(under_way, return_when=FIRST_COMPLETED)
                for future in done:
                    task, process = under_way.pop(future)
                    if isinstance(future.exception(), BrokenExecutor):
                        died.append(task)
                        continue
                    idle.append(process)
                    yield task, future.result()
        finally:
            for _, process in under_way.values():  # an interruption: their results would be lost
                for one in list((getattr(process, "_processes", None) or {}).values()):
                    one.kill()
            for process in (*idle, *(process for _, process in under_way.values())):
                process.shutdown(wait=False, cancel_futures=True)


def _leaves(task: Any) -> bool:
    try:
        pickle.dumps(task)
    except Exception:
        return False
    return True


class Futures:
    """Another executor, opened in a context, such as a pool of MPI processes; ``cores`` in words."""

    timing = "shared cores"

    def __init__(self, opened: Callable[[], AbstractContextManager[FuturesExecutor]], cores: str) -> None:
        self.opened, self.cores = opened, cores

    def outcomes(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | None]]:
        """Run all tasks; if the executor breaks, run each of the rest in a new process."""
        waiting = deque(tasks)
        under_way: dict[Future[R], T] = {}
        with self.opened() as executor:
            try:
                while waiting:
                    under_way[executor.submit(work, waiting[0])] = waiting[0]
                    waiting.popleft()
                for future in as_completed(list(under_way)):
                    result = self._result(future)
                    yield under_way.pop(future), result
            except BrokenExecutor:
                left = [*under_way.values(), *waiting]
                under_way.clear()
                yield from Pool(1).outcomes(work, left)
            finally:
                for future in under_way:
                    future.cancel()

    def _result(self, future: Future[R]) -> R | None:
        """Return the result of a task, None if Dask dropped it."""
        try:
            return future.result()
        except BrokenExecutor:
            raise
        except (Exception, asyncio.CancelledError, CancelledError) as error:
            if type(error).__name__ == "KilledWorker":
                return None
            raise MpmfwError(f"{self.cores}: a run was dropped: {error}") from error


def dask_cluster(place: Any) -> Futures:
    """Return the workers of a Dask ``Client``, a cluster or a scheduler's address; they share no files."""
    try:
        import distributed
    except ImportError as error:
        raise SceneError("--scheduler: needs Dask: pip install 'mpmfw[dask]'") from error
    said = f"--scheduler {place if isinstance(place, str) else type(place).__name__}"

    @contextmanager
    def client() -> Iterator[Any]:
        if isinstance(place, distributed.Client):
            yield place
            return
        try:
            if isinstance(place, str) and not place.startswith("inproc://"):
                _knock(distributed.comm, place)  # a client that cannot connect complains when it is collected
            dask: Any = distributed
            made = dask.Client(place, timeout=PATIENCE, set_as_default=False)
        except (ValueError, OSError, TypeError) as error:  # TypeError: tls:// without certificates
            text = f"{said}: no scheduler answers at this address ({error})"
            raise SceneError(f"{text}; expected an address such as tcp://127.0.0.1:8786") from error
        with made:
            yield made

    @contextmanager
    def opened() -> Iterator[FuturesExecutor]:
        with client() as one:
            yield one.get_executor(pure=False)

    with client() as one:
        workers = len(one.ncores())
    if not workers:
        raise SceneError(f"{said}: the scheduler has no workers")
    return Futures(opened, f"{workers} workers of a Dask cluster")


def _knock(comm: Any, address: str) -> None:
    """Connect to an address. Raise a ValueError if it is malformed, an OSError without an answer."""
    scheme, place = comm.parse_address(address)
    comm.registry.get_backend(scheme)
    socket.create_connection(comm.parse_host_port(place), timeout=PATIENCE).close()


def _begin_worker() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            connection.wait([parent.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def executor_of(executor: Any, jobs: int | None) -> Executor:
    """Return the ``executor``, or one with ``jobs`` processes."""
    if executor is not None and jobs not in (None, 1):
        raise SceneError("jobs: has no effect with an executor")
    if executor is None:
        if jobs is not None and jobs < 1:
            raise SceneError(f"jobs: must be at least 1, not {jobs}")
        return InProcess() if (jobs or cores()) == 1 else Pool(jobs)
    if isinstance(executor, FuturesExecutor):
        return Futures(lambda: nullcontext(executor), f"the workers of a {type(executor).__name__}")
    if isinstance(executor, str) or hasattr(executor, "scheduler_info") or hasattr(executor, "get_client"):
        return dask_cluster(executor)
    if hasattr(executor, "outcomes"):
        return executor  # type: ignore[no-any-return]
    raise SceneError(
        f"executor: {executor!r} cannot run tasks; expected one of concurrent.futures, or of Dask"
    )
