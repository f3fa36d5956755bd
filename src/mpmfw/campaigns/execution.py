"""How the runs of a grid take place: where, what is kept of them, and who is told."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypedDict

from mpmfw.campaigns.executors import Executor, executor_of
from mpmfw.campaigns.running import Progress
from mpmfw.campaigns.store import Store, store_of
from mpmfw.errors import SceneError


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
    """How runs take place."""

    #: an executor of ``concurrent.futures``, a ``Client`` or cluster of ``dask.distributed``, or the address
    #: of its scheduler
    executor: Any = None
    jobs: int | None = 1  #: processes of one thread each; 1 is this process itself, None one for each core
    #: folder of finished runs, from which a campaign takes what applies; without it nothing is kept
    store: str | os.PathLike[str] | None = None
    repeats: int | None = None  #: runs of each point, of which the cheapest counts; 1, or as a study says
    force: bool = False  #: whether runs may be past the limits of steps and frames
    progress: Progress | None = None  #: called after every run
    run_progress: Callable[[float, int], None] | None = None  #: called within runs in this process

    def __post_init__(self) -> None:
        repeats: Any = self.repeats  # a caller may give anything
        if repeats is not None and not (isinstance(repeats, int) and repeats >= 1):
            raise SceneError(f"repeats: must be at least 1, not {repeats!r}")

    @classmethod
    def of(cls, running: Mapping[str, Any], **others: Any) -> Execution:
        """Return these keywords, with ``others`` set over them."""
        return cls(**{**running, **others})

    def runner(self) -> Executor:
        """Return what runs tasks, as :func:`executor_of` does."""
        return executor_of(self.executor, self.jobs)

    def kept(self, output: str | os.PathLike[str] | None = None) -> Store:
        """Return the store: as named, ``<output>.runs`` or a temporary one."""
        return Store(self.store if self.store is not None else store_of(output))
