"""Ctrl-C and SIGTERM: a run stops between two things, never within a frame."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from mpmfw.errors import Interrupted

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interruption:
    """Turns both signals into Interrupted, or holds one back as ``waiting``."""

    def __init__(self) -> None:
        self.waiting: int | None = None
        self._deferred = False

    def __call__(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        """Take a signal; a second one does not wait."""
        if not self._deferred or self.waiting is not None:
            raise Interrupted(number)
        self.waiting = number

    @contextmanager
    def deferred(self) -> Iterator[None]:
        """Context in which the first signal waits for :meth:`check`."""
        self._deferred = True
        try:
            yield
        finally:
            self._deferred = False

    def check(self) -> None:
        """Raise Interrupted if a signal was held back."""
        number, self.waiting = self.waiting, None
        if number is not None:
            raise Interrupted(number)


@contextmanager
def interruptible() -> Iterator[Interruption]:
    """Context in which both signals are taken; in the main thread alone."""
    taking, before = Interruption(), {}
    if threading.current_thread() is threading.main_thread():
        for number in _SIGNALS:
            # A host that ignores or takes a signal itself goes on to do so
            if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
                before[number] = signal.signal(number, taking)
    try:
        yield taking
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def unbroken() -> Iterator[None]:
    """Context that no signal breaks off: the first is handled at its end."""
    before, received = {}, list[tuple[int, FrameType | None]]()
    if threading.current_thread() is threading.main_thread():
        for number in _SIGNALS:
            if callable(handler := signal.getsignal(number)):
                before[number] = handler
                signal.signal(number, lambda *arrived: received.append(arrived))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if received:
            before[signal.Signals(received[0][0])](*received[0])
