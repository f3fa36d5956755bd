"""Ctrl-C and SIGTERM: a run stops between steps or files, never within a frame."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from mpmfw.errors import Interrupted

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interruption:
    """Turns both signals into Interrupted; while ``deferring`` the first is held back as ``waiting``."""

    waiting: int | None = None
    deferring = False

    def __call__(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        """Take a signal; a second one does not wait."""
        if not self.deferring or self.waiting is not None:
            raise Interrupted(number)
        self.waiting = number


@contextmanager
def interruptible() -> Iterator[Interruption]:
    """Context that handles both signals; in the main thread alone."""
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
    """Context that signals do not interrupt; the first is handled at its end."""
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
