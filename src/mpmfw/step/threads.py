"""Several threads of one run: each has a part of an operation of the step; results are bitwise those of one.

Kernels release the interpreter's lock. Operations on points alone, or from the grid to points, are shared out
by points. Those from points to the grid are shared out by nodes: every thread goes through the points in
their order and adds to its range of nodes alone.

A thread that sleeps is awake 15 to 30 µs after it is called: as long as a small kernel. So threads look for a
while, in compiled code, at a number that another one writes.
"""

from __future__ import annotations

import itertools
import os
import time
import weakref
from collections import deque
from collections.abc import Callable, Sequence
from queue import SimpleQueue
from threading import Thread
from typing import Any, TypeVar

import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba.core import types
from numba.np import arrayobj

from mpmfw.kernels import kernel
from mpmfw.kernels._jit import intrinsic
from mpmfw.kernels.stencil import FULL, NodeRange
from mpmfw.kernels.types import Ints
from mpmfw.state.fields import IntArray
from mpmfw.state.structs import Stencil

_arrayobj: Any = arrayobj  # numba has no annotations here
Result = TypeVar("Result")

#: Numbers between two that different threads write: as many as a line of the cache has.
APART = 8

#: How often a thread looks whether there is something to do before it sleeps: 0.1 ms.
LOOKS = 300_000

#: As often the thread that calls looks away, 3 µs, while the others need the interpreter's lock.
FIRST_LOOKS = 48_000

#: Sleep of the thread that calls, when another has none of the cores [s].
NAP = 1e-4

#: Projections after which the nodes are shared out anew, because points move on.
RENEWAL = 256


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


class Threads:
    """Threads, at least 2, that share one operation at a time; the calling thread is the first of them.

    They start with the first operation, anew in a process that was forked, and end with this object. One
    thread projects alone unless ``rows_ascend``: the nodes of every row of the table ascend."""

    def __init__(self, count: int, *, rows_ascend: bool) -> None:
        self.count, self.rows_ascend = count, rows_ascend
        self._process = -1
        self._kept: dict[type, tuple[Any, list[Any]]] = {}  #: arrays of structs, and their parts
        self._shares: list[NodeRange] = []
        self._left = 0  #: tables until the nodes are shared out anew
        self._entries: list[int] = []  #: of every thread's rows in the last table

    def each(self, part: Callable[[int], Result]) -> list[Result]:
        """Return ``part(t)`` of every thread t, in their order, when all are done."""
        if self._process != os.getpid():
            self._process, self._team = os.getpid(), _Team(self.count)
            weakref.finalize(self, _dismiss, self._team, self._process)
        results = self._team.each(part)
        for result in results:
            if isinstance(result, BaseException):
                raise result
        return results

    def parts(self, first: int, last: int) -> list[tuple[int, int]]:
        """``first:last`` in as many ranges of equal length as there are threads."""
        cuts = [first + (last - first) * t // self.count for t in range(self.count + 1)]
        return list(itertools.pairwise(cuts))

    def firsts(self, first: IntArray) -> list[IntArray]:
        """Return ``first`` of the velocity fields for every thread's points."""
        return [np.clip(first, *part) for part in self.parts(0, int(first[-1]))]

    def over_points(self, kernel: Callable[..., int | None], *arguments: Any) -> int:
        """Call a kernel with every thread's part of points, arrays and table; return the first point that
        failed, or −1."""
        ranges = self.parts(0, len(arguments[0].mass))
        own = list(zip(*(self._parts_of(argument, ranges) for argument in arguments), strict=True))
        codes = self.each(lambda t: kernel(*own[t]))
        for (first, _), code in zip(ranges, codes, strict=True):
            if code is not None and code >= 0:
                return first + code
        return -1

    def _parts_of(self, argument: Any, ranges: list[tuple[int, int]]) -> list[Any]:
        """Return each thread's part of an array or struct, or all of it."""
        if isinstance(argument, np.ndarray):
            return [argument[begin:end] for begin, end in ranges]
        if not hasattr(argument, "part"):
            return [argument] * self.count
        arrays, parts = self._kept.get(type(argument), (None, []))
        if arrays is not argument.kernel_arrays:
            parts = [argument.part(*own) for own in ranges]
            self._kept[type(argument)] = argument.kernel_arrays, parts
        return parts

    def over_slices(self, kernel: Callable[..., Any], slices: Sequence[slice], *arguments: Any) -> None:
        """Call ``kernel(first, last, *arguments)`` for parts of slices."""
        ranges = [self.parts(own.start, own.stop) for own in slices]
        self.each(lambda t: [kernel(*each[t], *arguments) for each in ranges])

    def over_nodes(self, kernel: Callable[..., None], *arguments: Any) -> None:
        """Call a kernel of the step with every thread's share of the nodes."""
        if self._shares:
            self.each(lambda t: kernel(*arguments, self._shares[t]))
        else:
            kernel(*arguments)

    def share_nodes(self, table: Stencil) -> None:
        """Cut the nodes now and then so that as many points begin in each share."""
        if self._left == 0 and self.rows_ascend:
            lowest = table.nodes[table.row[:-1]]
            ranks = [len(lowest) * t // self.count for t in range(1, self.count)]
            cuts = [0, *np.partition(lowest, ranks)[ranks].tolist(), 2**31]
            self._shares, self._left = list(itertools.pairwise(cuts)), RENEWAL
        self._left -= 1

    def share_anew(self) -> None:
        """Share the nodes out anew with the next table: they have other indices."""
        self._left = 0

    def fill_rows(self, fill: Callable[[IntArray, int, int], int], first: IntArray, table: Stencil) -> int:
        """Fill a table of rows of varying length by ``fill(first, k, end)``, in parts that begin as before.

        Entries between two parts have weight 0. Return the first point outside, −1, or ``FULL``."""
        parts, firsts = self.parts(0, len(table.row) - 1), self.firsts(first)
        if self._entries:  # room for some more than last time
            begins = list(itertools.accumulate((n + n // 128 + 64 for n in self._entries[:-1]), initial=0))
        else:
            begins = [table.room * start // (len(table.row) - 1) for start, _ in parts]
        ends = [min(end, table.room) for end in (*begins[1:], table.room)]
        codes = self.each(lambda t: fill(firsts[t], begins[t], ends[t]))
        if FULL in codes and self._entries:
            self._entries = []
            return self.fill_rows(fill, first, table)
        if failed := [code for code in codes if code != -1]:
            return failed[0]
        row, nodes, weight, gradient = table.kernel_arrays
        self._entries = [int(row[last]) - k for (_, last), k in zip(parts, begins, strict=True)]
        for (start, _), k in zip(parts[1:], begins[1:], strict=True):
            spare = slice(int(row[start]), k)
            nodes[spare] = nodes[spare.start - 1]
            weight[spare] = gradient[spare] = 0.0
            row[start] = k
        return -1


class _Team:
    """The threads themselves. Part 0 is the caller's; whoever is free takes the next part, the caller too."""

    def __init__(self, count: int) -> None:
        self.count, self.round, self.ended = count, 0, False
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
        self.left.clear()  # of a round that an interruption broke off
        self.left.extend((part, t, self.round + 1) for t in range(1, self.count))
        self.call()
        self._do(part, 0)
        others = set(range(1, self.count))
        while (own := self._take()) is not None:
            others.remove(own[1])
            self._do(part, own[1])
        for t in others:
            while not wait(self.rounds, t, self.round, LOOKS):
                time.sleep(NAP)
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
        """What thread k does until it is dismissed."""
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


def _dismiss(team: _Team, process: int) -> None:
    """End the threads, in the process that started them."""
    if process == os.getpid():
        team.ended = True
        team.call()
