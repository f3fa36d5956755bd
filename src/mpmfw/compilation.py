"""Seconds spent in compiling and loading kernels, kept out of the cost of a method."""

from __future__ import annotations

import time
from types import TracebackType
from typing import Any, Self

from numba.core import event as numba_event

from mpmfw.clock import Clock

# numba's annotations differ between versions.
_event: Any = numba_event

#: numba holds its compiler lock while it compiles a kernel or loads it from the disk cache.
_LOCK = "numba:compiler_lock"


class CompileTimer(_event.Listener):  # type: ignore[misc]
    """Context in which compilation is measured and excluded from ``clock``.

    Attributes
    ----------
    seconds
        Wall time spent so far [s].
    """

    def __init__(self, clock: Clock) -> None:
        self.clock, self.seconds = clock, 0.0
        self._depth, self._wall, self._cpu = 0, 0.0, 0.0

    def on_start(self, event: Any) -> None:  # noqa: ARG002
        """The lock is taken; inner kernels take it again."""
        if self._depth == 0:
            self._wall, self._cpu = time.perf_counter(), time.process_time()
        self._depth += 1

    def on_end(self, event: Any) -> None:  # noqa: ARG002
        """The lock is given back."""
        self._depth -= 1
        if self._depth == 0:
            wall = time.perf_counter() - self._wall
            self.seconds += wall
            self.clock.exclude(wall, time.process_time() - self._cpu)

    def __enter__(self) -> Self:
        _event.register(_LOCK, self)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        _event.unregister(_LOCK, self)
