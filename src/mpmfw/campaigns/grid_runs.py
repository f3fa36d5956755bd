"""The runs of a grid: their executor, their store and their outcomes."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.campaigns.executors import InProcess, executor_of
from mpmfw.campaigns.grid import Combination, Index, RunGrid
from mpmfw.campaigns.judging import measured
from mpmfw.campaigns.running import Execution, Progress, complete, counted, do, resumable
from mpmfw.campaigns.store import COSTS, Cost, Finished, Outcome, Store, store_of
from mpmfw.campaigns.work import LOADED, Task
from mpmfw.errors import ResultsWarning, is_complete
from mpmfw.plugin.measure import Measure
from mpmfw.state.fields import STEP_STAGES


def costs_of(coords: Mapping[str, Sequence[Any]], costs: Mapping[Index, Sequence[Cost]]) -> xr.Dataset:
    """Return :data:`COSTS` and ``load`` (…, repeat), ``stages`` and ``settling`` (…, repeat, stage) [s]."""
    shape = tuple(len(labels) for labels in coords.values())
    most = max((1, *(len(many) for many in costs.values())))
    names = [name for name, _, _ in COSTS]
    values = np.full((*shape, most, len(names) + 1), np.nan)
    stages, settling = (np.full((*shape, most, len(STEP_STAGES)), np.nan) for _ in range(2))
    for index, many in costs.items():
        for k, cost in enumerate(many):
            values[index][k] = [*(cost.values.get(name, np.nan) for name in names), cost.others]
            stages[index][k] = [cost.stages.get(stage, np.nan) for stage in STEP_STAGES]
            settling[index][k] = [cost.settling.get(stage, np.nan) for stage in STEP_STAGES]
    lead = (*coords, "repeat")
    found = {name: (lead, values[..., k]) for k, name in enumerate((*names, "load"))}
    by_stage = {"stages": ((*lead, "stage"), stages), "settling": ((*lead, "stage"), settling)}
    named = {dim: list(labels) for dim, labels in coords.items()}
    return xr.Dataset({**found, **by_stage}, {**named, "stage": list(STEP_STAGES)})


def least(each: xr.Dataset) -> xr.Dataset:
    """Return for each run the repeat with the least CPU time, and the largest peak memory."""
    one = each.isel(repeat=each["cpu_time"].fillna(np.inf).argmin("repeat"))
    return one.assign(peak_memory=each["peak_memory"].max("repeat"))


def over_repeats(each: xr.Dataset) -> dict[str, xr.DataArray]:
    """Return half the range of the CPU time, the repeats and the mean load."""
    times = each["cpu_time"]
    count = times.count("repeat")
    spread, load = 0.5 * (times.max("repeat") - times.min("repeat")), each["load"].mean("repeat")
    half, busy = "half the range of the repeats; NaN for a single one", "cores that other processes kept busy"
    return {
        "cpu_time_spread": spread.where(count > 1).assign_attrs(units="s", long_name=half),
        "repeats": count.astype(float).assign_attrs(units="1", long_name="runs of the cost"),
        "load": load.assign_attrs(units="1", long_name=busy),
    }


def timing_of(costs: Sequence[Cost]) -> str:
    """Return ``exclusive`` if all costs were measured one run at a time."""
    if not costs:
        return ""
    if any(cost.timing != "exclusive" for cost in costs):
        return "shared cores"
    loaded = sum(cost.others > LOADED for cost in costs)
    return f"exclusive, {loaded} of {len(costs)} on a loaded machine" if loaded else "exclusive"


class GridRuns:
    """The runs of a grid, with their store and executor; messages call the whole ``what``.

    With ``exclusive`` only costs that were measured one run at a time count.
    """

    def __init__(
        self,
        grid: RunGrid,
        what: str,
        execution: Execution,
        *,
        output: str | os.PathLike[str] | None = None,
        exclusive: bool = False,
        threads: int = 1,
    ) -> None:
        self.grid, self.what, self.execution, self.exclusive = grid, what, execution, exclusive
        self.executor = executor_of(execution.executor, execution.jobs)
        self.store = Store(execution.store if execution.store is not None else store_of(output))
        self.threads = threads if isinstance(self.executor, InProcess) else 1

    def complete(self, only: Collection[Index] | None = None, progress: Progress | None = None) -> None:
        """Run the missing points, all or ``only`` some."""
        points, how = self.grid.combinations, self.execution
        grid = self.grid if only is None else replace(self.grid, combinations={i: points[i] for i in only})
        tasks = grid.tasks(how.force, self.threads)
        tell = how.progress if progress is None else progress
        with resumable(self.store, self.what):
            times = 1 if how.repeats is None else how.repeats
            complete(tasks, self.store, self.executor, times, self.exclusive, tell, how.run_progress)

    def do(self, work: Callable[[Task], Finished]) -> None:
        """Do ``work`` for the missing points instead of running them."""
        with resumable(self.store, self.what):
            do(work, self.grid.tasks().values(), self.store, self.executor, self.execution.progress)

    def outcome(self, index: Index) -> Outcome | None:
        """Return the outcome of a point, or None."""
        key = self.grid.combinations[index].key
        return self.store.outcome(key) if key else None

    def results(self, index: Index) -> xr.DataTree | None:
        """Return the results of a point's run, or None."""
        outcome = self.outcome(index)
        return None if outcome is None or not outcome.digest else self.store.results(outcome.key)

    def known(self) -> Iterator[tuple[Index, Combination, Outcome]]:
        """Yield the points that have an outcome, in order."""
        for index, one in self.grid.combinations.items():
            outcome = self.outcome(index)
            if outcome is not None:
                yield index, one, outcome

    def statuses(self) -> dict[Index, str]:
        """Return the status of every point."""
        refused = {i: f"refused: {one.why}" for i, one in self.grid.combinations.items() if not one.key}
        begun = dict.fromkeys(self.grid.combinations, "not run") | refused
        return begun | {index: outcome.status for index, _, outcome in self.known()}

    def costs(self) -> dict[Index, list[Cost]]:
        """Return the costs that count, of points that have any."""
        every = {index: counted(outcome, self.exclusive) for index, _, outcome in self.known()}
        return {index: costs for index, costs in every.items() if costs}

    def conditions(self) -> dict[str, str]:
        """Return processor, cores and timing of the costs."""
        every = [cost for many in self.costs().values() for cost in many]
        processors = sorted({cost.machine for cost in every if cost.machine})
        return {"processor": ", ".join(processors), "cores": self.executor.cores, "timing": timing_of(every)}

    def notes(self) -> dict[str, list[str]]:
        """Return warnings about results, by the name of a point."""
        return {one.name: [*outcome.notes] for _, one, outcome in self.known() if outcome.notes}

    def warn(self) -> None:
        """Issue the warnings about results."""
        for name, notes in self.notes().items():
            for note in notes:
                warnings.warn(f"{name}: {note}", ResultsWarning, stacklevel=3)

    def complete_results(self, index: Index) -> xr.DataTree | None:
        """Return the results of a point's run if it finished, else None."""
        outcome = self.outcome(index)
        return None if outcome is None or not is_complete(outcome.status) else self.results(index)

    def numbers(self, measure: Measure) -> xr.DataArray:
        """Return a measure over the grid."""
        found = measured(measure, self.grid, self.complete_results)
        values = {index: float(one.values[0]) for index, one in found.items()}
        return self.grid.array(values, measure.meaning, measure.unit)
