"""The runs of a grid: what does them, where they are kept, and what is known of them."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from typing import Any

import xarray as xr

from mpmfw.campaigns.costs import timing_of
from mpmfw.campaigns.executors import InProcess, executor_of
from mpmfw.campaigns.grid import Combination, Index, RunGrid
from mpmfw.campaigns.judging import measured
from mpmfw.campaigns.outcome import Cost, Finished, Outcome
from mpmfw.campaigns.running import Progress, Repeats, complete, counted, do, resumable
from mpmfw.campaigns.store import Store, store_of
from mpmfw.campaigns.work import Task
from mpmfw.errors import ResultsWarning, is_complete
from mpmfw.plugin.measure import About, Measure


class GridRuns:
    """The runs of a grid, which a store keeps and an executor does.

    Parameters
    ----------
    grid
        The points.
    what
        What the whole is called where an interruption says how to go on.
    output, store
        Folder of finished runs: ``store``, else ``<output>.runs``; without both nothing is kept.
    executor, jobs
        As :func:`mpmfw.campaign` takes them.
    exclusive
        Whether those costs alone count that were measured one run at a time.
    threads
        Of each run, if runs take place in this process.
    """

    def __init__(
        self,
        grid: RunGrid,
        what: str,
        *,
        output: str | os.PathLike[str] | None = None,
        store: str | os.PathLike[str] | None = None,
        executor: Any = None,
        jobs: int | None = None,
        exclusive: bool = False,
        threads: int = 1,
    ) -> None:
        self.grid, self.what, self.exclusive = grid, what, exclusive
        # 1 is what most requests have by default: beside an executor it says nothing
        self.executor = executor_of(executor, None if executor is not None and jobs == 1 else jobs)
        self.threads = threads if self.here else 1
        self.store = Store(store if store is not None else store_of(output))

    @property
    def here(self) -> bool:
        """Whether runs take place in this process."""
        return isinstance(self.executor, InProcess)

    def complete(
        self,
        repeats: Repeats,
        progress: Progress | None = None,
        report: Callable[[float, int], None] | None = None,
        force: bool = False,
        only: Collection[Index] | None = None,
    ) -> None:
        """Run what is missing, repeats for the cost included, as :func:`mpmfw.campaigns.running.complete` does.

        Parameters
        ----------
        repeats, progress, report, force
            As it takes them, and as :func:`mpmfw.campaign` does.
        only
            Points to run; None is all.

        Raises
        ------
        Interrupted
            Ctrl-C or SIGTERM.
        """
        points = self.grid.combinations
        grid = self.grid if only is None else replace(self.grid, combinations={i: points[i] for i in only})
        tasks = grid.tasks(force, self.threads)
        with resumable(self.store, self.what):
            complete(tasks, self.store, self.executor, repeats, self.exclusive, progress, report)

    def do(self, work: Callable[[Task], Finished], progress: Progress | None = None) -> None:
        """Do other work with the points that are missing.

        Raises
        ------
        Interrupted
            Ctrl-C or SIGTERM.
        """
        with resumable(self.store, self.what):
            do(work, self.grid.tasks().values(), self.store, self.executor, progress)

    def outcome(self, index: Index) -> Outcome | None:
        """What came of a point; None where it was not run, or is refused."""
        key = self.grid.combinations[index].key
        return self.store.outcome(key) if key else None

    def results(self, index: Index) -> xr.DataTree | None:
        """What a point's run wrote; None if nothing."""
        outcome = self.outcome(index)
        return None if outcome is None or not outcome.digest else self.store.results(outcome.key)

    def known(self) -> Iterator[tuple[Index, Combination, Outcome]]:
        """The points of which something is known, in order."""
        for index, one in self.grid.combinations.items():
            outcome = self.outcome(index)
            if outcome is not None:
                yield index, one, outcome

    def statuses(self) -> dict[Index, str]:
        """How every point went: ``ok``, why not, why it is refused, or ``not run``."""
        refused = {i: f"refused: {one.refusal}" for i, one in self.grid.combinations.items() if not one.key}
        begun = dict.fromkeys(self.grid.combinations, "not run") | refused
        return begun | {index: outcome.status for index, _, outcome in self.known()}

    def costs(self) -> dict[Index, list[Cost]]:
        """The costs that count, of points that have any."""
        every = {index: counted(outcome, self.exclusive) for index, _, outcome in self.known()}
        return {index: costs for index, costs in every.items() if costs}

    def conditions(self) -> dict[str, str]:
        """Under which conditions costs were measured: processor, cores, timing."""
        every = [cost for many in self.costs().values() for cost in many]
        processors = sorted({cost.machine for cost in every if cost.machine})
        return {"processor": ", ".join(processors), "cores": self.executor.cores, "timing": timing_of(every)}

    def notes(self, naming: Callable[[Combination], str]) -> dict[str, list[str]]:
        """What readers of results must know, by the name of a point."""
        return {naming(one): [*outcome.notes] for _, one, outcome in self.known() if outcome.notes}

    def warn(self, naming: Callable[[Combination], str]) -> None:
        """Say what readers of results must know."""
        for name, notes in self.notes(naming).items():
            for note in notes:
                warnings.warn(f"{name}: {note}", ResultsWarning, stacklevel=3)

    def succeeded(self) -> dict[Index, bool]:
        """Whether each point came to its end, suspect ones included."""
        return {index: is_complete(status) for index, status in self.statuses().items()}

    def numbers(self, measure: Measure) -> xr.DataArray:
        """A measure that is a number, over the grid; NaN where it is not known."""
        found = measured(measure, self.grid, self.results, self.succeeded(), About())
        values = {index: float(one.values[0]) for index, one in found.items()}
        return self.grid.array(values, measure.meaning, measure.unit)
