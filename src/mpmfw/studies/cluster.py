"""Runs on a Dask cluster, reached by its scheduler's address; needs the extra ``mpmfw[dask]``."""

from __future__ import annotations

import asyncio
import socket
import uuid
from collections.abc import Iterator, Sequence
from typing import Any

from mpmfw.errors import MpmfwError, SceneError
from mpmfw.studies.executors import Outcome, Work
from mpmfw.studies.work import Task

#: Seconds to wait for the scheduler to answer.
_PATIENCE = 10.0


class Cluster:
    """Workers of a Dask cluster that share no files with this process.

    A worker that dies loses nothing: the scheduler gives its tasks to others. One whose workers die again and again
    (Dask's ``allowed-failures``) is given up.

    Parameters
    ----------
    address
        Of the scheduler, such as ``tcp://127.0.0.1:8786``.

    Raises
    ------
    SceneError
        Dask is not installed, or no scheduler answers there.
    """

    timing = "shared cores"

    def __init__(self, address: str) -> None:
        try:
            import distributed
        except ImportError as error:
            raise SceneError("--scheduler: needs Dask: pip install 'mpmfw[dask]'") from error
        self._distributed: Any = distributed
        self.address = address
        self._check_address()
        with self._client() as client:
            if not client.scheduler_info()["workers"]:
                raise SceneError(f"--scheduler {address}: the scheduler has no workers")

    def _check_address(self) -> None:
        """Knock before there is a client: one that cannot connect complains a second time when it is collected."""
        comm = self._distributed.comm
        try:
            scheme, place = comm.parse_address(self.address)
            comm.registry.get_backend(scheme)
            socket.create_connection(comm.parse_host_port(place), timeout=_PATIENCE).close()
        except ValueError as error:
            raise SceneError(
                f"--scheduler {self.address}: {error}; expected an address such as tcp://127.0.0.1:8786"
            ) from error
        except OSError as error:
            raise self._silent(error) from error

    def _silent(self, error: Exception) -> SceneError:
        return SceneError(f"--scheduler {self.address}: no scheduler answers there ({error})")

    def _client(self) -> Any:
        try:
            return self._distributed.Client(self.address, timeout=_PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:  # it went away in between
            raise self._silent(error) from error

    def outcomes(self, work: Work, tasks: Sequence[Task]) -> Iterator[Outcome]:
        """Do all tasks on the cluster."""
        with self._client() as client:
            # A name of its own for each, so that the scheduler does not answer from memory
            under_way = {
                client.submit(work, task, key=f"{task.key}-{uuid.uuid4()}", pure=False): task
                for task in tasks
            }
            try:
                for future in self._distributed.as_completed(list(under_way), loop=client.loop):
                    result = self._result(future)
                    yield under_way.pop(future), result  # the worker may forget it
            finally:
                client.cancel(list(under_way))

    def _result(self, future: Any) -> Any:
        """What a task returned; None if the processes that ran it died."""
        try:
            # Waits on if the worker died after the run and before it was fetched: others do the run anew
            return future.result()
        except self._distributed.scheduler.KilledWorker:
            return None
        except (Exception, asyncio.CancelledError) as error:
            raise MpmfwError(f"the cluster at {self.address} gave up a run: {error}") from error
