"""The coarse runs of a choice: which are made, and the dataset of what they say."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.campaigns.costs import costs_of, least
from mpmfw.campaigns.grid import Index, RunGrid
from mpmfw.campaigns.grid_runs import GridRuns
from mpmfw.campaigns.judging import ErrorTable, Judge
from mpmfw.errors import SimulationError
from mpmfw.plugin.measure import Measure
from mpmfw.results.provenance import provenance
from mpmfw.studies.chances import chances, price
from mpmfw.studies.fitting import CostFit, ErrorFit, Pilot
from mpmfw.studies.verdicts import Chance, Method, Task, Verdict, best_of, verdict, with_reasons

#: A third run of a method is made where it takes at most this share of the answer's cost, or where nothing is certain without.
THIRD = 0.2
#: At most so many methods have a third run.
THIRDS = 2


class Pilots:
    """Runs what a choice needs, coarse cells first.

    Parameters
    ----------
    runs
        Of the grid (contact, shape, cell_size), whose cell sizes fall.
    measure, kind
        Whose error it is, and what kind of thing the error is against; with ``finest`` the run of the first method at the
        smallest cell size.
    target
        Relative error.
    complete
        Makes the runs of some points.
    at_once
        Runs that are made at a time.
    """

    def __init__(
        self,
        runs: GridRuns,
        measure: Measure,
        kind: str,
        target: float,
        complete: Callable[[Collection[Index]], None],
        at_once: int = 1,
    ) -> None:
        self.runs, self.grid, self._complete, self._at_once = runs, runs.grid, complete, at_once
        labels = self.grid.coords
        self.ladder: list[float] = labels["cell_size"]
        self.methods: list[Method] = [
            (contact, shape)
            for contact in range(len(labels["contact"]))
            for shape in range(len(labels["shape"]))
        ]
        finest = {"contact": labels["contact"][0], "shape": labels["shape"][0]} if kind == "finest" else {}
        table = ErrorTable.model_validate({"quantity": measure.name, "kind": kind, "finest": finest})
        self.judge = Judge(table, self.grid)
        self.reference = (0, 0, len(self.ladder) - 1) if finest else None
        scene = next(one.scene for one in self.grid.combinations.values() if one.scene is not None)
        self.task = Task(target, self.ladder, measure.kind == "number", scene.dim)
        self.prices = {method: price(self.grid.combinations[*method, 0].scene) for method in self.methods}
        self.pruned: dict[Method, Chance] = {}
        self.asked: set[Index] = set()
        self._found: dict[Index, Pilot] = {}

    def run(self) -> None:
        """Make the runs at the coarsest cells, then at the next, until one meets the target or none is left that may; a few at
        the third. The next run is the one that is cheapest for its chance of meeting the target.

        Raises
        ------
        SimulationError
            The run that errors are against has no result.
        """
        if self.reference:
            self._ask({self.reference})
            if self.reference not in self._found:
                status = self.runs.statuses()[self.reference]
                raise SimulationError(
                    f"the run that errors are to be against, {self.grid.combinations[self.reference].name}, cannot be used: "
                    f"{status}; expected another method in the first place, or coarser cells"
                )
            self._ask({(*self.reference[:2], k) for k in (0, 1)})  # what it is off by itself
        for k in (0, 1):
            while waiting := self._waiting(k):
                self._ask({(*method, k) for method in waiting[: self._at_once]})
        if len(self.ladder) > 2:
            self._ask({(*method, 2) for method in self._thirds()})

    def _waiting(self, k: int) -> list[Method]:
        """Methods that are worth a run at a cell size, the next one first."""
        verdicts, found = self.verdicts(), self.found()
        left = [method for method in self.methods if (*method, k) not in self.asked]
        known = {
            (i[0], i[1]): self._found[i].error if i in self._found else 1.0 for i in self.asked if i[2] == 0
        }
        beforehand = chances(self.methods, known, self.task.target)
        runs = {
            method: self._chance(found[method], k)
            if found[method]
            else Chance(self.prices[method], beforehand[method])
            for method in left
        }
        return sorted((m for m in left if self._worth(m, runs[m], verdicts)), key=lambda m: runs[m].price)

    def _chance(self, pilots: list[Pilot], k: int) -> Chance:
        """Of the next run of a method that has one: it costs at least as many steps more."""
        fit = ErrorFit(pilots, self.task.signed)
        least = pilots[-1].cost * pilots[-1].cell_size / self.ladder[k]
        return Chance(least, fit.chance(self.ladder[k], self.task.target))

    def _ask(self, points: set[Index]) -> None:
        """Make runs, and read them; others that the store may hold are not looked at, so that no answer depends on them."""
        self._complete(points)
        self.asked |= points
        costs, status = self._costs(), self.runs.statuses()
        read = points | ({self.reference} if self.reference else set())
        judged = self.judge.judge(self.runs.results, {index: status[index] == "ok" for index in read})
        for index in points:
            one, cost = judged[index], costs.isel(dict(zip(self.grid.coords, index, strict=True)))
            error = one.value / one.expected - 1.0 if self.task.signed else one.error
            if index == self.reference and status[index] == "ok":
                error = 0.0
            if np.isfinite(error) and np.isfinite(cost["cpu_time"]):
                values = (float(cost[name]) for name in ("cpu_time", "steps", "material_points"))
                self._found[index] = Pilot(self.ladder[index[2]], float(error), *values)

    def _worth(self, method: Method, run: Chance, verdicts: Mapping[Method, Verdict]) -> bool:
        """Whether the next run of a method is expected to save more than it takes, where a run meets the target already.

        What is out of reach with the best order of convergence is not run either.
        """
        best = best_of({name: one for name, one in verdicts.items() if one.kind == "measured"})
        if best is None:
            return verdicts[method].kind != "out of reach"
        cost = verdicts[best].cost
        if not self.found()[method]:  # prices are of use as ratios alone
            run = Chance(cost * run.cost / max(self.prices[best], 1e-9), run.of_target)
        if run.saves(cost):
            return True
        self.pruned[method] = run
        return False

    def _thirds(self) -> list[Method]:
        """Methods whose third run may change the answer, the cheapest first."""
        verdicts, found = self.verdicts(), self.found()
        best = best_of(verdicts)
        if best is not None and verdicts[best].kind == "measured":
            return []
        limit = np.inf if best is None else THIRD * verdicts[best].cost
        costs = {
            method: CostFit(found[method], self.task.dim).at(self.ladder[2])
            for method, one in verdicts.items()
            if method not in self.pruned and (one.kind == "predicted" or _is_likely(one, self.task))
        }
        return sorted((method for method in costs if costs[method] <= limit), key=costs.__getitem__)[:THIRDS]

    def found(self) -> dict[Method, list[Pilot]]:
        """The runs of every method that have an error, at falling cell sizes."""
        return {
            method: [self._found[i] for i in sorted(self._found) if i[:2] == method]
            for method in self.methods
        }

    def verdicts(self) -> dict[Method, Verdict]:
        """What is known of every method."""
        found = self.found()
        task = self.task.with_slack(self._slack(found))
        return {
            method: Verdict("not run")
            if method in self.pruned and (*method, 0) not in self.asked
            else verdict(found[method], task)
            for method in self.methods
        }

    def _slack(self, found: Mapping[Method, list[Pilot]]) -> float:
        """What the run that errors are against is off by itself: its distance from the next coarser one of its method.

        That is its error if it falls with the cells at first order to nothing.
        """
        if self.reference is None:
            return 0.0
        own = [
            pilot
            for pilot in found[self.reference[0], self.reference[1]]
            if pilot.cell_size > self.ladder[-1]
        ]
        if not own:
            return np.inf
        ratio = own[-1].cell_size / self.ladder[-1]
        return abs(own[-1].error) / (ratio - 1.0)

    def _costs(self) -> xr.Dataset:
        """CPU time and steps, settling included, and points of every run."""
        each = least(costs_of(self.grid.coords, self.runs.costs()))
        settling = each["settle_time"].fillna(0.0), each["settle_steps"].fillna(0.0)
        return each.assign(cpu_time=each["cpu_time"] + settling[0], steps=each["steps"] + settling[1])

    def dataset(self) -> xr.Dataset:
        """Join what is known, as :func:`mpmfw.choose` returns it."""
        found, statuses = self.found(), self._statuses()
        failures = {
            method: next(
                (statuses[*method, k] for k in (1, 0) if statuses[*method, k] != "not run"), "not run"
            )
            for method in self.methods
        }
        task = self.task.with_slack(self._slack(found))
        verdicts = with_reasons(self.verdicts(), failures, self.pruned, task)
        errors: dict[Index, float] = {
            (*method, self.ladder.index(pilot.cell_size)): abs(pilot.error)
            for method, pilots in found.items()
            for pilot in pilots
        }
        dataset = xr.Dataset(coords={dim: list(labels) for dim, labels in self.grid.coords.items()})
        dataset["status"] = self.grid.array(statuses, "ok, or why it is suspect or has no result")
        dataset["error"] = self.grid.array(errors, f"relative error of: {self.judge.measure.meaning}", "1")
        costs = self._costs()["cpu_time"].where(dataset["status"] != "not run")
        dataset["cpu_time"] = costs.assign_attrs(units="s", long_name="CPU time of the steps and of settling")
        dataset = dataset.assign(_by_method(self.grid, verdicts, best_of(verdicts)))
        dataset.attrs = self._attributes(task) | self.runs.conditions()
        return dataset

    def _statuses(self) -> dict[Index, str]:
        """How every run went that was asked for; ``not run`` of all others."""
        known, points = self.runs.statuses(), self.grid.combinations
        refused = {i: f"refused: {points[i].why}" for i in self.asked if points[i].scene is None}
        return dict.fromkeys(points, "not run") | {i: known[i] for i in self.asked} | refused

    def _attributes(self, task: Task) -> dict[str, Any]:
        scene = next(iter(self.grid.scenes.values()))
        own = self.reference is not None
        first = ", ".join(str(self.grid.coords[dim][0]) for dim in ("contact", "shape"))
        against = f"the run of {first} at cells of {self.ladder[-1]:.4g} m" if own else self.judge.describe()
        return {
            "kind": "choice",
            "title": scene.title or scene.name,
            "scene": scene.text,
            "quantity": self.judge.measure.name,
            "error_against": against,
            "slack": task.slack,
            "target": task.target,
            "versions": json.dumps(provenance()["versions"]),
        }


def _is_likely(one: Verdict, task: Task) -> bool:
    """Whether a method that is not certain to meet the target rather does at the finest cells."""
    return one.kind == "unsure" and one.error.median <= task.target


#: Numbers of a verdict: name, unit, meaning.
_NUMBERS = (
    ("cell_size_needed", "m", "largest cell that meets the target; else the finest that was considered"),
    ("predicted_error", "1", "relative error there, the median"),
    ("lower", "1", "bound that it is above with 95 %"),
    ("upper", "1", "bound that it is below with 95 %"),
    ("cost", "s", "CPU time there, settling included"),
    ("limit", "1", "size of e0 in e = e0 + C h^p"),
    ("order", "1", "p of the same"),
)


def _by_method(
    grid: RunGrid, verdicts: Mapping[Method, Verdict], best: Method | None
) -> dict[str, xr.DataArray]:
    """The verdicts over contact and shape."""
    dims = ("contact", "shape")
    shape = tuple(len(grid.coords[dim]) for dim in dims)
    numbers = np.full((*shape, len(_NUMBERS)), np.nan)
    words = {name: np.full(shape, "", dtype=object) for name in ("verdict", "why")}
    answer = np.zeros(shape, dtype=bool)
    for method, one in verdicts.items():
        error = one.error
        numbers[method] = (
            one.cell_size,
            error.median,
            error.low,
            error.high,
            one.cost,
            one.limit.median,
            one.order,
        )
        words["verdict"][method], words["why"][method] = one.kind, one.why
        answer[method] = method == best
    found = {
        name: xr.DataArray(numbers[..., k], dims=dims, attrs={"units": unit, "long_name": meaning})
        for k, (name, unit, meaning) in enumerate(_NUMBERS)
    }
    texts = {name: xr.DataArray(values, dims=dims) for name, values in words.items()}
    return {"answer": xr.DataArray(answer, dims=dims), **found, **texts}
