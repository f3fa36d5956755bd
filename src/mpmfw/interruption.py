"""Ctrl-C and SIGTERM: a run stops between two things, never within a frame."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from mpmfw.errors import Interrupted


class Interruption:
    """Turns both signals into :class:`~mpmfw.errors.Interrupted`, and holds them back where asked to."""

    def __init__(self) -> None:
        self._held = 0
        self._waiting: int | None = None

    def __call__(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        """Take a signal."""
        if self._held:
            self._waiting = number
        else:
            raise Interrupted(number)

    def whole(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, which a signal does not break off: it takes effect after the call."""

        def call(*arguments: Any) -> Any:
            self._held += 1
            try:
                return function(*arguments)
            finally:
                self._held -= 1
                number, self._waiting = self._waiting, None
                if number is not None:
                    raise Interrupted(number)

        return call


@contextmanager
def interruptible() -> Iterator[Interruption]:
    """Context in which both signals are taken; in another thread than the main one they are left alone."""
    taking = Interruption()
    if threading.current_thread() is not threading.main_thread():
        yield taking
        return
    before = {}
    for number in (signal.SIGINT, signal.SIGTERM):
        # A host that ignores or takes a signal itself goes on to do so
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            before[number] = signal.signal(number, taking)
    try:
        yield taking
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
