"""The runs of a choice: coarse to fine, cheapest first, until two laws agree within the target."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr

from mpmfw.campaigns.grid import Index
from mpmfw.campaigns.grid_runs import GridRuns, costs_of, least
from mpmfw.campaigns.judging import Judge, interpolated
from mpmfw.plugin.measure import Measured
from mpmfw.state.fields import FloatArray

#: A method: indices of its contact and its shape function.
Method = tuple[int, int]

#: Orders of convergence between which an error is taken to fall with the cell size.
ORDERS = (1.0, 2.0)
#: Order that no error falls faster with: a method that would miss the target even so is not refined.
BEST_ORDER = 3.0


@dataclass(frozen=True)
class Limit:
    """A motion at cells of size zero, extrapolated from two laws."""

    motion: Measured  #: mean of the two laws' extrapolations
    uncertainty: float  #: relative: half their distance, and what the order of convergence leaves open
    laws: tuple[str, str]  #: labels of the two methods


class Ladder:
    """Runs methods at falling cell sizes until one meets the ``target``; ``at_once`` methods at a time.

    A ``judge`` of kind ``finest`` has no reference: errors are then against :class:`Limit`.
    """

    def __init__(self, runs: GridRuns, judge: Judge, target: float, at_once: int = 1) -> None:
        self.runs, self.judge, self.target, self._at_once = runs, judge, target, at_once
        contacts, shapes, self.sizes = (runs.grid.coords[dim] for dim in ("contact", "shape", "cell_size"))
        # The first shape function with every contact, then the next
        self.methods: list[Method] = [(i, j) for j in range(len(shapes)) for i in range(len(contacts))]
        self._labels = {(i, j): f"{contacts[i]}, {shapes[j]}" for i, j in self.methods}
        laws = [str(contact).partition("(")[0] for contact in contacts]
        several = len({*laws}) > 1
        #: What tells methods apart that confirm each other: the law; where all have one, the shape function.
        self._laws = {(i, j): laws[i] if several else str(shapes[j]) for i, j in self.methods}
        self.asked: set[Index] = set()
        self.errors: dict[Index, float] = {}
        self.limit: Limit | None = None

    @property
    def slack(self) -> float:
        """Relative uncertainty of the reference."""
        if self.judge.is_exact:
            return 0.0
        return np.inf if self.limit is None else self.limit.uncertainty

    def run(self) -> None:
        """Run the methods at one cell size after another until one meets the target."""
        sizes = list(range(len(self.sizes)))
        rungs = [[k] for k in sizes] if self.judge.is_exact else [sizes[:2], *([k] for k in sizes[2:])]
        for rung in rungs:
            waiting = self._waiting(rung[0])
            for start in range(0, len(waiting), self._at_once):
                together = waiting[start : start + self._at_once]
                self._ask({(*method, k) for method in together for k in rung})
                if self.answer() is not None:
                    return

    def _waiting(self, k: int) -> list[Method]:
        """Return methods worth a run at a cell size, the cheapest first."""
        if k == 0:
            return self.methods
        status, costs = self.runs.statuses(), self.costs()
        most = self.target * (self.sizes[k - 1] / self.sizes[k]) ** BEST_ORDER
        before = [(*method, k - 1) for method in self.methods]
        worth = [
            index
            for index in before
            if index in self.asked
            and status[index] == "ok"
            and (not self.judge.is_exact or self.errors.get(index, np.inf) <= most)
        ]
        return [index[:2] for index in sorted(worth, key=lambda index: float(costs[index]))]

    def _ask(self, points: Collection[Index]) -> None:
        self.runs.complete(points)
        self.asked |= {*points}
        status = self.runs.statuses()
        succeeded = {index: status[index] == "ok" for index in self.asked}
        if self.judge.is_exact:
            judged = self.judge.judge(self.runs.results, succeeded)
        else:
            found = self.judge.measured(self.runs.results, succeeded)
            self.limit = min(self._limits(found), key=lambda one: one.uncertainty, default=None)
            if self.limit is None:
                return
            motion = self.limit.motion
            judged = {i: self.judge.compare(one, interpolated(motion, one)) for i, one in found.items()}
        self.errors = {i: judged[i].error for i in sorted(self.asked) if i in judged}
        self.errors = {i: error for i, error in self.errors.items() if np.isfinite(error)}

    def _limits(self, found: dict[Index, Measured]) -> Iterator[Limit]:
        for k in range(len(self.sizes) - 1, 0, -1):
            ran = [m for m in self.methods if (*m, k) in found and (*m, k - 1) in found]
            ratio = self.sizes[k - 1] / self.sizes[k]
            pairs = [(a, b) for a, b in itertools.combinations(ran, 2) if self._laws[a] != self._laws[b]]
            for pair in pairs:
                at = found[*pair[0], k]
                first, second = (extrapolated(found[*m, k - 1], found[*m, k], ratio, at) for m in pair)
                yield joined(at.time, first, second, (self._labels[pair[0]], self._labels[pair[1]]))
            if pairs:
                return

    def meets(self, index: Index) -> bool:
        """Return True if a run is below the target with its uncertainty."""
        return self.errors.get(index, np.inf) + self.slack <= self.target

    def answer(self) -> Index | None:
        """Return the cheapest run that meets the target, or None."""
        costs = self.costs()
        able = [index for index in self.errors if self.meets(index)]
        return min(able, key=lambda index: float(costs[index]), default=None)

    def costs(self) -> xr.DataArray:
        """Return the CPU time of every run, settling included [s]."""
        each = least(costs_of(self.runs.grid.coords, self.runs.costs()))
        return each["cpu_time"] + each["settle_time"].fillna(0.0)

    def against(self) -> str:
        """Return in words what errors are against."""
        if self.judge.is_exact:
            return self.judge.describe()
        if self.limit is None:
            return "nothing: no two laws ran at two cell sizes"
        return f"the limit at cells of size zero that {' and '.join(self.limit.laws)} tend to"


def extrapolated(
    coarse: Measured, fine: Measured, ratio: float, at: Measured
) -> tuple[FloatArray, FloatArray]:
    """Return what two runs of a method tend to, and the half width that the order of convergence leaves open.

    Their cell sizes have the ``ratio``; the times are those of the run ``at``."""
    end = interpolated(fine, at)
    step = end - interpolated(coarse, at)
    farthest, nearest = (1.0 / (ratio**order - 1.0) for order in ORDERS)
    return end + 0.5 * (farthest + nearest) * step, 0.5 * (farthest - nearest) * np.abs(step)


def joined(
    time: FloatArray,
    first: tuple[FloatArray, FloatArray],
    second: tuple[FloatArray, FloatArray],
    laws: tuple[str, str],
) -> Limit:
    """Return the limit of two laws."""
    middle = 0.5 * (first[0] + second[0])
    width = 0.5 * np.abs(first[0] - second[0]) + np.maximum(first[1], second[1])
    uncertainty = float(np.max(width) / np.max(np.abs(middle)))
    return Limit(Measured(middle, time), uncertainty if np.isfinite(uncertainty) else np.inf, laws)
