"""Seconds spent in compiling and loading kernels, kept out of the cost of a method."""

from __future__ import annotations

import importlib
import sys
import time
from types import TracebackType
from typing import Any, Self

from numba.core import event as numba_event

from mpmfw.step.timestep import Clock

# numba's annotations differ between versions.
_event: Any = numba_event

#: numba holds its compiler lock while it compiles a kernel or loads it from the disk cache.
_LOCK = "numba:compiler_lock"


def import_numba_without_scipy() -> None:
    """Import numba's functions of arrays before numba does so with the first kernel, and without
    ``scipy.linalg``.

    numba asks whether there is a BLAS as it imports them, which loads scipy and a dozen of its and NumPy's
    packages. No kernel of ours calls BLAS, and numba asks once more as it compiles one that does."""
    if "numba.np.arraymath" in sys.modules:
        return
    linalg: Any = importlib.import_module("numba.np.linalg")
    ensure_blas = getattr(linalg, "ensure_blas", None)
    if ensure_blas is None:  # a numba that asks in another way
        return
    linalg.ensure_blas = lambda: None
    try:
        arraymath: Any = importlib.import_module("numba.np.arraymath")
    finally:
        linalg.ensure_blas = ensure_blas
    arraymath.ensure_blas = ensure_blas


class CompileTimer(_event.Listener):  # type: ignore[misc]
    """Context that measures the ``seconds`` of compilation and excludes them from ``clock``."""

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
