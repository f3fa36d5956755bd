"""Several threads of one run: each has a part of a line of the step, and the result is the same to the bit as
with one.

Kernels let go of the interpreter's lock, so that Python threads are enough. Nothing here depends on when a
thread is done:

- lines that go from the grid to the points, or over points alone, are shared out by points, none of which
  asks another;
- lines that go from points to the grid are shared out by nodes. Every thread goes through the points in their
  order, and adds to its own nodes alone what a single thread would add to them, one after the other.

Imported where a run has more than one thread.
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
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from mpmfw.kernels import _waiting as waiting
from mpmfw.kernels.stencil import FULL, NodeRange
from mpmfw.state.fields import IndexArray, IntArray

if TYPE_CHECKING:
    from mpmfw.state.structs import Stencil

Result = TypeVar("Result")

#: How often a thread looks whether there is something to do before it sleeps: 0.1 ms.
LOOKS = 300_000

#: As often the thread that calls looks away, before it needs the interpreter's lock itself: 3 µs, in which
#: the others come from the call to their kernels. Who asks for the lock while another has it sleeps, and is
#: awake 20 µs later.
FIRST_LOOKS = 48_000

#: Sleep of the thread that calls, when another has none of the cores [s].
NAP = 1e-4

#: Projections after which the nodes are shared out anew: points move on, and the threads should have equally
#: many.
RENEWAL = 256


class Threads:
    """Threads, at least 2, that share one line at a time; the calling thread is the first of them.

    They start with the first line, end with this object, and are started anew in a process that was forked.
    One thread projects alone unless ``rows_ascend``: the nodes of every row of the table ascend."""

    def __init__(self, count: int, *, rows_ascend: bool) -> None:
        self.count, self.rows_ascend = count, rows_ascend
        self._process = -1
        self._kept: dict[type, tuple[Any, list[Any]]] = {}  #: arrays of structs, and their parts
        self._shares: list[NodeRange] = []
        self._left = 0  #: tables until the nodes are shared out anew
        self._entries: list[int] = []  #: of every thread's rows in the last table

    def each(self, part: Callable[[int], Result]) -> list[Result]:
        """``part(t)`` for every thread t; the results, in their order, when all are done."""
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
        """``first`` of the velocity fields' points, for every thread with its part of the points alone."""
        return [np.clip(first, *part) for part in self.parts(0, int(first[-1]))]

    def over_points(self, kernel: Callable[..., int | None], *arguments: Any) -> int:
        """Call a kernel of the step with every thread's part of the points, their arrays, table, and arrays
        beside.

        Return the first point of which the kernel says that it failed, −1 if it does of none."""
        ranges = self.parts(0, len(arguments[0].mass))
        own = list(zip(*(self._parts_of(argument, ranges) for argument in arguments), strict=True))
        codes = self.each(lambda t: kernel(*own[t]))
        for (first, _), code in zip(ranges, codes, strict=True):
            if code is not None and code >= 0:
                return first + code
        return -1

    def _parts_of(self, argument: Any, ranges: list[tuple[int, int]]) -> list[Any]:
        """Return each thread's part of an argument: of an array, or of what has a method ``part``; all else
        is everybody's.

        Parts of structs are kept while their arrays are the same.
        """
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
        """``kernel(first, last, *arguments)`` for parts of every slice of the points."""
        ranges = [self.parts(own.start, own.stop) for own in slices]

        def part(t: int) -> None:
            for each in ranges:
                kernel(*each[t], *arguments)

        self.each(part)

    def over_nodes(self, kernel: Callable[..., None], *arguments: Any) -> None:
        """A kernel of the step with every thread's share of the nodes, as :meth:`share_nodes` cut them."""
        if self._shares:
            self.each(lambda t: kernel(*arguments, self._shares[t]))
        else:
            kernel(*arguments)

    def share_nodes(self, row: IntArray, nodes: IndexArray) -> None:
        """Cut the nodes where as many points begin below as above; now and then, since any cut gives the same
        sums."""
        if self._left == 0 and self.rows_ascend:
            lowest = nodes[row[:-1]]
            ranks = [len(lowest) * t // self.count for t in range(1, self.count)]
            cuts = [0, *np.partition(lowest, ranks)[ranks].tolist(), 2**31]
            self._shares, self._left = list(itertools.pairwise(cuts)), RENEWAL
        self._left -= 1

    def share_anew(self) -> None:
        """Share the nodes out anew with the next table: they have other indices."""
        self._left = 0

    def fill_rows(self, fill: Callable[[IntArray, int, int], int], first: IntArray, table: Stencil) -> int:
        """Fill a table of rows of varying length by ``fill(first, k, end)``, in parts that begin as last
        time.

        Between two parts are a few entries of weight 0, the last node of the row before once more. Return the
        first point outside its window, −1, or ``FULL`` if the table is too short."""
        begins, firsts = self._begins(table), self.firsts(first)
        ends = [*begins[1:], table.room]
        codes = self.each(lambda t: fill(firsts[t], begins[t], ends[t]))
        if FULL in codes and self._entries:
            self._entries = []
            return self.fill_rows(fill, first, table)
        code = next((code for code in codes if code != -1), -1)
        if code == -1:
            self._join(table, begins)
        return code

    def _begins(self, table: Stencil) -> list[int]:
        """Where every thread's entries begin: with room for some more than last time, or for equally many a
        point."""
        if self._entries:
            return list(itertools.accumulate((n + n // 128 + 64 for n in self._entries[:-1]), initial=0))
        count = len(table.row) - 1
        return [table.room * first // count for first, _ in self.parts(0, count)]

    def _join(self, table: Stencil, begins: list[int]) -> None:
        """Make one table of the parts, and note how many entries they have."""
        row, nodes, weight, gradient = table.kernel_arrays
        parts = self.parts(0, len(row) - 1)
        self._entries = [int(row[last]) - k for (_, last), k in zip(parts, begins, strict=True)]
        for (first, _), k in zip(parts[1:], begins[1:], strict=True):
            spare = slice(int(row[first]), k)
            nodes[spare] = nodes[spare.start - 1]
            weight[spare] = gradient[spare] = 0.0
            row[first] = k


class _Team:
    """The threads themselves, which know nothing of the object that they work for: it may end before them.

    Part 0 is the caller's, every other part that of the thread which takes it first: the caller takes what is
    left when it has done its own, so that a thread which other processes keep from the cores holds up nothing
    that it has not begun.
    """

    def __init__(self, count: int) -> None:
        self.count, self.round, self.ended = count, 0, False
        #: Number 0: the last round that was called. Number t: the last round in which another thread has done
        #: part t
        self.rounds = np.zeros(2 * count * waiting.APART, dtype=np.int64)
        self.results: list[Any] = [None] * count
        self.left: deque[tuple[Callable[[int], Any], int, int]] = (
            deque()
        )  #: parts that nobody has begun, and their round
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
            while not waiting.wait(self.rounds, t, self.round, LOOKS):
                time.sleep(NAP)
        return self.results.copy()

    def call(self) -> None:
        """Begin a round."""
        self.round += 1
        for k, asleep in enumerate(self.asleep):
            if asleep:
                self.calls[k].put(None)
        waiting.begin(self.rounds, self.round, FIRST_LOOKS)

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
                number, done = self.count + k, seen  # nobody looks at this number
            else:
                part, number, done = taken
                self._do(part, number)
                del part, taken
            if waiting.end(self.rounds, number, done, LOOKS):
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
