"""Threads that wait for each other's parts of an operation (:mod:`mpmfw.step.threads`).

A thread that sleeps is awake 15 to 30 µs after it is called: as long as a small kernel. So threads look for a
while, in compiled code, at a number that another one writes.
"""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Callable
from queue import SimpleQueue
from threading import Thread
from typing import Any

import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import types
from numba.np import arrayobj

from mpmfw.kernels import kernel
from mpmfw.kernels._jit import intrinsic
from mpmfw.kernels.types import Ints

_arrayobj: Any = arrayobj  # numba has no annotations here

#: Numbers between two that different threads write: as many as a line of the cache has.
APART = 8

#: Reads of a number before a thread that waits for work sleeps, 0.1 ms.
LOOKS = 300_000

#: Reads during which the calling thread leaves the interpreter's lock to the others, 3 µs.
FIRST_LOOKS = 48_000

#: Sleep of the thread that calls, when another has none of the cores [s].
NAP = 1e-4


def _address(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    data = _arrayobj.make_array(array_type)(context, builder, array).data
    return builder.gep(data, [builder.mul(index, ir.Constant(ir.IntType(64), APART))])


@intrinsic
def read(_typing: Any, numbers: Any, t: Any) -> Any:  # noqa: ARG001
    """Number ``t`` as another thread wrote it last, and all that it wrote before."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.load_atomic(_address(context, builder, signature.args[0], *args), "acquire", 8)

    return types.int64(numbers, types.intp), codegen


@intrinsic
def write(_typing: Any, numbers: Any, t: Any, value: Any) -> Any:  # noqa: ARG001
    """Write number ``t`` for other threads, after all that was written before."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        address = _address(context, builder, signature.args[0], *args[:2])
        builder.store_atomic(args[2], address, "release", 8)
        return context.get_dummy_value()

    return types.void(numbers, types.intp, types.int64), codegen


@kernel
def wait(numbers: Ints, t: int, value: int, looks: int) -> bool:
    """Look at number ``t`` some times; return True once it is ``value``."""
    for _ in range(looks):  # noqa: SIM110
        if read(numbers, t) == value:
            return True
    return False


@kernel
def begin(numbers: Ints, value: int, looks: int) -> None:
    """Write number 0, which all threads look at, and wait a little."""
    write(numbers, 0, value)
    for _ in range(looks):
        read(numbers, 0)


@kernel
def end(numbers: Ints, t: int, value: int, looks: int) -> bool:
    """Write number ``t``; return True once number 0 is not ``value``."""
    write(numbers, t, value)
    for _ in range(looks):  # noqa: SIM110
        if read(numbers, 0) != value:
            return True
    return False


class Team:
    """Threads that share the parts of an operation. The caller does part 0; each free thread, and the caller,
    takes the next part."""

    def __init__(self, count: int) -> None:
        self.count, self.round, self.ended = count, 0, False
        self.worked = self.waited = 0.0  #: time of the calling thread [s]
        self.helped = 0  #: parts that others did
        #: The last round that was called, then for each part the last round in which another thread did it.
        self.rounds = np.zeros(2 * count * APART, dtype=np.int64)
        self.results: list[Any] = [None] * count
        #: Parts that no thread has begun, and their round.
        self.left: deque[tuple[Callable[[int], Any], int, int]] = deque()
        self.asleep = [False] * count
        self.calls: list[SimpleQueue[None]] = [SimpleQueue() for _ in range(count)]
        for k in range(1, count):
            Thread(target=self._work, args=(k,), name="mpmfw", daemon=True).start()

    def each(self, part: Callable[[int], Any]) -> list[Any]:
        """Results, or exceptions, of ``part(t)``."""
        begins = time.perf_counter()
        self.left.clear()  # of a round that an interruption broke off
        self.left.extend((part, t, self.round + 1) for t in range(1, self.count))
        self.call()
        self._do(part, 0)
        others = set(range(1, self.count))
        while (own := self._take()) is not None:
            others.remove(own[1])
            self._do(part, own[1])
        done, self.helped = time.perf_counter(), self.helped + len(others)
        for t in others:
            while not wait(self.rounds, t, self.round, LOOKS):
                time.sleep(NAP)
        self.worked += done - begins
        self.waited += time.perf_counter() - done
        return self.results.copy()

    def call(self) -> None:
        """Begin a round."""
        self.round += 1
        for k, asleep in enumerate(self.asleep):
            if asleep:
                self.calls[k].put(None)
        begin(self.rounds, self.round, FIRST_LOOKS)

    def _take(self) -> tuple[Callable[[int], Any], int, int] | None:
        try:
            return self.left.popleft()
        except IndexError:
            return None

    def _do(self, part: Callable[[int], Any], t: int) -> None:
        try:
            self.results[t] = part(t)
        except BaseException as error:  # raised in the thread that asked
            self.results[t] = error

    def _work(self, k: int) -> None:
        """Do parts as thread k until the team ends."""
        seen = 0
        while not self.ended:
            taken = self._take()
            if taken is None:
                number, done = self.count + k, seen  # this number is not read
            else:
                part, number, done = taken
                self._do(part, number)
                del part, taken
            if end(self.rounds, number, done, LOOKS):
                seen = self.round
                continue
            self.asleep[k] = True
            while self.round == seen:
                self.calls[k].get()
            self.asleep[k] = False
            seen = self.round


def dismiss(team: Team, process: int) -> None:
    """End the threads, in the process that started them."""
    if process == os.getpid():
        team.ended = True
        team.call()
