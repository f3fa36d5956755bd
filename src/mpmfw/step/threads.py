"""Several threads of one run: each has a part of an operation of the step; results are bitwise those of one.

Kernels release the interpreter's lock. Operations on points alone, or from the grid to points, are shared out
by points. Those from points to the grid are shared out by nodes: every thread goes through the points in
their order and adds to its range of nodes alone. Where other processes have the cores, one thread goes on
alone for a while.
"""

from __future__ import annotations

import itertools
import os
import weakref
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from mpmfw.kernels.stencil import FULL, NodeRange
from mpmfw.state.fields import IntArray
from mpmfw.state.structs import Stencil
from mpmfw.step.team import Team, dismiss

Result = TypeVar("Result")

#: Operations over which it is judged whether sharing pays.
JUDGED = 64

#: Operations that one thread does alone where it does not: the first time, and at most; they double.
ALONE, LONGEST = 1024, 16384

#: Projections after which the nodes are shared out anew, because points move on.
RENEWAL = 256


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
        self._shared = self._alone = 0  #: operations since it was judged, and left to do alone
        self._next = ALONE  #: to do alone the next time

    def each(self, part: Callable[[int], Result]) -> list[Result]:
        """Return ``part(t)`` of every thread t, in their order, when all are done."""
        if self._process != os.getpid():
            self._process, self._team = os.getpid(), Team(self.count)
            weakref.finalize(self, dismiss, self._team, self._process)
        if self._alone > 0:
            self._alone -= 1
            return [part(t) for t in range(self.count)]
        results = self._team.each(part)
        self._judge(self._team)
        for result in results:
            if isinstance(result, BaseException):
                raise result
        return results

    def _judge(self, team: Team) -> None:
        """Leave the other threads out for a while if they do less than half of their parts, or this one waits
        for them longer than the parts take: other processes have the cores."""
        self._shared += 1
        if self._shared < JUDGED:
            return
        others = self.count - 1
        if team.helped < 0.5 * others * JUDGED or team.waited > others * team.worked:
            self._alone, self._next = self._next, min(2 * self._next, LONGEST)
        else:
            self._next = ALONE
        self._shared = team.helped = 0
        team.worked = team.waited = 0.0

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
        if self._alone > 0:
            self._alone -= 1
            return -1 if (code := kernel(*arguments)) is None else code
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
        if self._shares and self._alone == 0:
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
