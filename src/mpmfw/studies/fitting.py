"""Error and cost of a method at cells that nobody has run, from two or three coarse runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

Vector = npt.NDArray[np.float64]

#: Orders of convergence p that are thought possible, and what is believed of ln p beforehand: mean and standard deviation.
ORDERS = np.geomspace(0.5, 3.0, 13)
_LN_ORDER = (np.log(1.2), 0.6)
#: Scatter of an error about a smooth curve, from where outlines lie in their cells: of the error itself, and in any case.
SCATTER, FLOOR = 0.15, 2e-4
#: Standard deviation of e0, over the error at the finest run; of C, over the largest error.
_SPREAD_E0, _SPREAD_C = 1.0, 4.0
#: Share of the probability between the bounds of an interval.
WITHIN = 0.9


@dataclass(frozen=True)
class Pilot:
    """A run that has ended.

    Attributes
    ----------
    cell_size
        [m].
    error
        Relative; with its sign where the measure is a number, else not negative.
    cost
        CPU time of the steps, settling included [s].
    steps
        Time steps, those of settling included.
    points
        Material points.
    """

    cell_size: float
    error: float
    cost: float
    steps: float
    points: float


@dataclass(frozen=True)
class Interval:
    """A predicted size of an error: the median, and bounds that hold :data:`WITHIN` of the probability."""

    median: float
    low: float
    high: float


class ErrorFit:
    """What runs at some cell sizes let expect of e(h) = e0 + C h^p at others.

    Three unknowns and two or three errors: every p of :data:`ORDERS` and every e0 of a fine range is weighed by how well it
    explains the errors, with the best C for each (Bayes' rule; C is eliminated in closed form, since the errors are linear in
    it). Beforehand p is thought near 1.2, within 0.5 and 3; e0 of the size of the finest run's error, its sign open for
    a number, and C wide. Errors scatter by :data:`SCATTER` of themselves. A prediction is the mixture of all; its interval is
    wide where two runs cannot tell a slow convergence from one that ends at e0. A coarse run whose error is more than 2^3 (for
    twice the cell) of the next one's has not begun to converge, and is left out.

    Parameters
    ----------
    pilots
        At falling cell sizes; at least one.
    signed
        Whether errors have signs, so that e0 may have either; else it is not negative.
    """

    def __init__(self, pilots: Sequence[Pilot], signed: bool) -> None:
        used = _convergent(pilots)
        self._unit = used[0].cell_size
        x = np.array([pilot.cell_size / self._unit for pilot in used])
        y = np.array([pilot.error for pilot in used])
        size = max(abs(y[-1]), FLOOR)
        reach = np.linspace(-4.0 if signed else 0.0, 4.0, 161 if signed else 81)
        p, e0 = (grid.ravel() for grid in np.meshgrid(ORDERS, size * reach, indexing="ij"))
        variance = (SCATTER * y) ** 2 + FLOOR**2
        power, rest = x ** p[:, None], y - e0[:, None]
        prior = (_SPREAD_C * np.abs(y).max() + FLOOR) ** 2
        self._variance = 1.0 / (1.0 / prior + (power**2 / variance).sum(axis=1))
        self._slope = self._variance * (power * rest / variance).sum(axis=1)
        misfit = (rest**2 / variance).sum(axis=1) - self._slope**2 / self._variance
        belief = ((np.log(p) - _LN_ORDER[0]) / _LN_ORDER[1]) ** 2 + (e0 / (_SPREAD_E0 * size)) ** 2
        logarithm = 0.5 * (np.log(self._variance) - misfit - belief)
        weight = np.exp(logarithm - logarithm.max())
        kept = weight > 1e-6  # the others are not worth their time
        self._weight = weight[kept] / weight[kept].sum()
        self.order, self.limit = p[kept], e0[kept]
        self._slope, self._variance = self._slope[kept], self._variance[kept]

    def at(self, cell_size: float) -> Interval:
        """The size of the error that a run at a cell size [m] would have."""
        mean, spread = self._mixture(cell_size)
        largest = float(np.max(np.abs(mean) + 4.0 * spread))
        tail = 0.5 * (1.0 - WITHIN)
        return Interval(
            *(
                _quantile(lambda size: self._below(size, mean, spread), share, largest)
                for share in (0.5, tail, 1.0 - tail)
            )
        )

    def chance(self, cell_size: float, size: float) -> float:
        """Probability that a run at a cell size [m] has an error below a size."""
        return self._below(size, *self._mixture(cell_size))

    def _mixture(self, cell_size: float) -> tuple[Vector, Vector]:
        """Mean and standard deviation of the error at a cell size, of every p and e0."""
        x = cell_size / self._unit
        mean = self.limit + self._slope * x**self.order
        return mean, np.sqrt(self._variance * x ** (2.0 * self.order) + (SCATTER * mean) ** 2 + FLOOR**2)

    def _below(self, size: float, mean: Vector, spread: Vector) -> float:
        """Probability of an error below a size."""
        return float(self._weight @ (ndtr((size - mean) / spread) - ndtr((-size - mean) / spread)))

    def level(self) -> Interval:
        """The size of e0, which finer cells do not go below."""
        size = np.abs(self.limit)
        order = np.argsort(size)
        share = np.cumsum(self._weight[order])
        tail = 0.5 * (1.0 - WITHIN)
        places = np.searchsorted(share, (0.5, tail, 1.0 - tail)).clip(max=len(order) - 1)
        return Interval(*map(float, size[order][places]))

    @property
    def expected_order(self) -> float:
        """Mean of p."""
        return float(self._weight @ self.order)


def _convergent(pilots: Sequence[Pilot]) -> list[Pilot]:
    """The runs from the first one on at which errors fall no faster than the highest order lets them."""
    for k in range(len(pilots) - 1, 0, -1):
        coarse, fine = pilots[k - 1], pilots[k]
        most = (coarse.cell_size / fine.cell_size) ** float(ORDERS[-1])
        if abs(coarse.error) > most * max(abs(fine.error), FLOOR):
            return list(pilots[k:])
    return list(pilots)


def _quantile(below: Callable[[float], float], share: float, largest: float) -> float:
    """The size that a share of the probability is below, by bisection."""
    low, high = 0.0, largest
    for _ in range(30):
        middle = 0.5 * (low + high)
        if below(middle) < share:
            low = middle
        else:
            high = middle
    return high


class CostFit:
    """CPU time at other cell sizes: steps times (a + b points), a for the calls of a step and b for each material point.

    Steps grow as 1/h^q, where q is what two runs say, within 0.5 and 1.5, else 1; points as 1/h^dim. One run alone says
    nothing of a, which is then 0.

    Parameters
    ----------
    pilots
        At falling cell sizes; at least one.
    dim
        Of the scene.
    """

    def __init__(self, pilots: Sequence[Pilot], dim: int) -> None:
        first, self._last, self._dim = pilots[0], pilots[-1], dim
        self._growth, self._call, self._point = 1.0, 0.0, 0.0
        each = [pilot.cost / max(pilot.steps, 1.0) for pilot in pilots]
        if len(pilots) > 1:
            ratio = first.cell_size / self._last.cell_size
            growth = np.log(max(self._last.steps, 1.0) / max(first.steps, 1.0)) / np.log(ratio)
            self._growth = float(np.clip(growth, 0.5, 1.5))
            points = max(self._last.points - first.points, 1.0)
            self._point = min(max((each[-1] - each[0]) / points, 0.0), each[-1] / self._last.points)
            self._call = each[-1] - self._point * self._last.points
        else:
            self._point = each[-1] / max(self._last.points, 1.0)

    def at(self, cell_size: float) -> float:
        """CPU time of a run at a cell size [s]."""
        finer = self._last.cell_size / cell_size
        steps = self._last.steps * finer**self._growth
        return float(max(steps, 1.0) * (self._call + self._point * self._last.points * finer**self._dim))
