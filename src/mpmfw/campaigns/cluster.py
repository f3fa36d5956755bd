"""Runs on a Dask cluster: a client, a cluster's object, or a scheduler's address; needs the extra ``mpmfw[dask]``."""

from __future__ import annotations

import asyncio
import socket
import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Any, TypeVar

from mpmfw.errors import MpmfwError, SceneError

T = TypeVar("T")
R = TypeVar("R")

#: Seconds to wait for the scheduler to answer.
_PATIENCE = 10.0


class Cluster:
    """Workers of a Dask cluster that share no files with this process.

    A worker that dies loses nothing: the scheduler gives its tasks to others. One whose workers die again and again
    (Dask's ``allowed-failures``) is given up.

    Parameters
    ----------
    place
        A ``distributed.Client``, which is left open; a cluster's object such as a ``LocalCluster``; or the scheduler's
        address, such as ``tcp://127.0.0.1:8786``. For ``tls://`` Dask's own configuration names the certificates.

    Raises
    ------
    SceneError
        Dask is not installed, no scheduler answers there, or it has no workers.
    """

    timing = "shared cores"

    def __init__(self, place: Any) -> None:
        try:
            import distributed
        except ImportError as error:
            raise SceneError("--scheduler: needs Dask: pip install 'mpmfw[dask]'") from error
        self._distributed: Any = distributed
        self.place = place
        self.said = place if isinstance(place, str) else type(place).__name__
        if isinstance(place, str) and not place.startswith("inproc://"):
            self._check_address(place)
        with self._client() as client:
            workers = len(client.ncores())
        if not workers:
            raise SceneError(f"--scheduler {self.said}: the scheduler has no workers")
        self.cores = f"{workers} workers of a Dask cluster"

    def _check_address(self, address: str) -> None:
        """Knock before there is a client: one that cannot connect complains a second time when it is collected."""
        comm = self._distributed.comm
        try:
            scheme, place = comm.parse_address(address)
            comm.registry.get_backend(scheme)
            socket.create_connection(comm.parse_host_port(place), timeout=_PATIENCE).close()
        except ValueError as error:
            raise SceneError(
                f"--scheduler {address}: {error}; expected an address such as tcp://127.0.0.1:8786"
            ) from error
        except OSError as error:
            raise self._silent(error) from error

    def _silent(self, error: Exception) -> SceneError:
        return SceneError(f"--scheduler {self.said}: no scheduler answers there ({error})")

    def _client(self) -> AbstractContextManager[Any]:
        """A client, closed at the end unless it is the caller's own."""
        if hasattr(self.place, "scheduler_info") and not hasattr(self.place, "get_client"):
            return nullcontext(self.place)
        try:
            client: AbstractContextManager[Any] = self._distributed.Client(
                self.place, timeout=_PATIENCE, set_as_default=False
            )
        except (OSError, ValueError) as error:  # it went away in between
            raise self._silent(error) from error
        except TypeError as error:  # a tls:// address without certificates
            raise SceneError(
                f"--scheduler {self.said}: {error}; expected its certificates in Dask's own configuration, or a Client or "
                "cluster that knows them"
            ) from error
        return client

    def outcomes(self, work: Callable[[T], R], tasks: Sequence[T]) -> Iterator[tuple[T, R | None]]:
        """Do all tasks on the cluster."""
        with self._client() as client:
            # A name of its own for each, so that the scheduler does not answer from memory
            under_way = {
                client.submit(work, task, key=f"mpmfw-{uuid.uuid4()}", pure=False): task for task in tasks
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
            raise MpmfwError(f"the cluster at {self.said} gave up a run: {error}") from error
