"""Signals are held back where something must be whole."""

import signal
import threading

import pytest

from mpmfw.errors import Interrupted
from mpmfw.runs.interruption import interruptible, unbroken


def test_a_signal_takes_effect_after_what_must_be_whole():
    done = []
    with interruptible():
        if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
            pytest.skip("the host takes signals itself")
        with pytest.raises(Interrupted) as stopped, unbroken():  # noqa: PT012
            signal.raise_signal(signal.SIGTERM)
            signal.raise_signal(signal.SIGTERM)
            done.append("whole")
        assert (done, stopped.value.number) == (["whole"], signal.SIGTERM)
        with unbroken():
            done.append("again")
        with pytest.raises(Interrupted):
            signal.raise_signal(signal.SIGTERM)


def test_an_error_within_is_its_own_and_another_thread_takes_no_signals():
    with pytest.raises(ValueError, match="mine"), unbroken():
        raise ValueError("mine")
    done = []

    def work():
        with unbroken():
            done.append(signal.getsignal(signal.SIGINT))

    before = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert done == [before] == [signal.getsignal(signal.SIGINT)]
