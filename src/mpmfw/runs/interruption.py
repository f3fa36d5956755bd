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
    """Turns both signals into :class:`~mpmfw.errors.Interrupted`, or holds the number of one back in
    ``waiting``.
    """

    def __init__(self) -> None:
        self.waiting: int | None = None
        self._held = 0
        self._deferred = False

    def __call__(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        """Take a signal; one that waits already is not asked to wait longer by a second, but where a call
        must be whole.
        """
        if self._held or (self._deferred and self.waiting is None):
            self.waiting = number
        else:
            raise Interrupted(number)

    @contextmanager
    def deferred(self) -> Iterator[None]:
        """Context in which the first signal waits until :meth:`check` is called; a second takes effect at
        once.
        """
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

    def whole(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, which a signal does not break off: it takes effect after the call."""

        def call(*arguments: Any) -> Any:
            self._held += 1
            try:
                return function(*arguments)
            finally:
                self._held -= 1
                if not self._deferred:
                    self.check()

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


@contextmanager
def unbroken() -> Iterator[None]:
    """Context that no signal breaks off: whoever takes signals gets at its end the first that came."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    taken = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    before = {number: handler for number, handler in taken.items() if callable(handler)}
    received: list[tuple[int, FrameType | None]] = []
    for number in before:
        signal.signal(number, lambda *arrived: received.append(arrived))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if received:
            before[signal.Signals(received[0][0])](*received[0])
