"""The runs of a choice: coarse to fine, until most laws agree within the target."""

from __future__ import annotations

from collections.abc import Collection
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
#: A motion at cells of size zero, and its half width.
Extrapolated = tuple[FloatArray, FloatArray]

#: Orders of convergence between which an error is taken to fall with the cell size.
ORDERS = (1.0, 2.0)
#: Order that no error falls faster with: a method that would miss the target even so is not refined.
BEST_ORDER = 3.0


@dataclass(frozen=True)
class Limit:
    """Extrapolation to zero cell size, on which most laws agree."""

    motion: Measured  #: the extrapolation of one method
    uncertainty: float  #: relative: largest distance and half width of the laws that agree
    laws: tuple[str, ...]  #: labels of a method of each law that agrees


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
        #: How methods differ that confirm each other: the law; where all have one, the shape function.
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
            and (self._error(index) <= most or self.slack > self.target)
        ]
        # Without an exact motion the promising ones come first, since these also narrow the limit
        close = 0.0 if self.judge.is_exact else 2.0 * min(map(self._error, worth), default=0.0)
        worth.sort(key=lambda index: (self._error(index) > close > 0.0, float(costs[index])))
        return [index[:2] for index in worth]

    def _error(self, index: Index) -> float:
        return self.errors.get(index, np.inf)

    def _ask(self, points: Collection[Index]) -> None:
        self.runs.complete(points)
        self.asked |= {*points}
        status = self.runs.statuses()

        def results(index: Index) -> xr.DataTree | None:
            return self.runs.results(index) if index in self.asked and status[index] == "ok" else None

        if self.judge.is_exact:
            judged = self.judge.judge(results)
        else:
            found = {
                i: one for i, one in self.judge.measured(results).items() if np.isfinite(one.values).all()
            }
            self.limit = self._agreed(found)
            if self.limit is None:
                return
            motion = self.limit.motion
            judged = {i: self.judge.compare(one, interpolated(motion, one)) for i, one in found.items()}
        self.errors = {i: judged[i].error for i in sorted(self.asked) if i in judged}
        self.errors = {i: error for i, error in self.errors.items() if np.isfinite(error)}

    def _agreed(self, found: dict[Index, Measured]) -> Limit | None:
        """Return the extrapolation on which more than half of all laws, two at least, agree best.

        Two laws that converge slowly may agree by chance, far from the limit. Most laws rarely do."""
        needed = max(2, len({*self._laws.values()}) // 2 + 1)
        finest = {}
        for method in self.methods:
            sizes = [k for k in range(1, len(self.sizes)) if {(*method, k - 1), (*method, k)} <= found.keys()]
            if sizes:
                finest[method] = sizes[-1]
        if len({self._laws[method] for method in finest}) < needed:
            return None
        at = found[max(((*method, k) for method, k in finest.items()), key=lambda index: index[-1])]
        tend = {
            method: extrapolated(
                found[*method, k - 1], found[*method, k], self.sizes[k - 1] / self.sizes[k], at
            )
            for method, k in finest.items()
        }
        agreed = (self._around(method, tend, needed, at.time) for method in tend)
        return min(agreed, key=lambda one: one.uncertainty)

    def _around(
        self, centre: Method, tend: dict[Method, Extrapolated], count: int, time: FloatArray
    ) -> Limit:
        """Return one method's extrapolation, uncertain by the distance of the ``count`` nearest laws."""
        middle = tend[centre][0]
        size = np.max(np.abs(middle))
        nearest: dict[str, tuple[float, str]] = {}
        for method, (other, width) in tend.items():
            away = float(np.max(np.abs(other - middle) + width) / size)
            law = self._laws[method]
            nearest[law] = min(nearest.get(law, (np.inf, "")), (away, self._labels[method]))
        close = sorted(nearest.values())[:count]
        uncertainty = close[-1][0]
        labels = tuple(label for _, label in close)
        return Limit(Measured(middle, time), uncertainty if np.isfinite(uncertainty) else np.inf, labels)

    def meets(self, index: Index) -> bool:
        """Return True if a run's error plus its uncertainty is below the target."""
        return self._error(index) + self.slack <= self.target

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
            return "nothing: no two laws have a value at two cell sizes; expected more contacts"
        return f"the limit at cells of size zero that {' and '.join(self.limit.laws)} tend to"


def extrapolated(coarse: Measured, fine: Measured, ratio: float, at: Measured) -> Extrapolated:
    """Return the limit of two runs whose cells have the ``ratio``, and its half width, at times of ``at``."""
    end = interpolated(fine, at)
    step = end - interpolated(coarse, at)
    farthest, nearest = (1.0 / (ratio**order - 1.0) for order in ORDERS)
    return end + 0.5 * (farthest + nearest) * step, 0.5 * (farthest - nearest) * np.abs(step)
