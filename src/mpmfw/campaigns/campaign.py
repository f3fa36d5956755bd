"""``mpmfw.campaign``: a grid of runs as one dataset."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Unpack

import xarray as xr

from mpmfw.campaigns.grid import RunGrid, make_grid
from mpmfw.campaigns.grid_runs import GridRuns, costs_of, least, over_repeats
from mpmfw.campaigns.judging import judge_all
from mpmfw.campaigns.running import Event, Execution, Running
from mpmfw.campaigns.store import COSTS
from mpmfw.errors import ResultsWarning, SceneError, status_code
from mpmfw.results.concatenation import concatenate_runs


def campaign(
    scene: Any,
    vary: Mapping[str, Sequence[Any]],
    *,
    measures: Iterable[str] = (),
    reference: Mapping[str, Any] | None = None,
    set: Mapping[str, Any] | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Run a scene at all points of a grid, and join what came of them.

    Parameters
    ----------
    scene
        A file, the name of a shipped scene, or a mapping.
    vary
        Values by key: ``contact`` and ``shape`` (names, names with options, configured strategy objects),
        short names such as ``cell_size``, or dotted keys of the scene. A dimension each, in this order.
    measures
        Names of quantities to read off every run, see :data:`mpmfw.campaigns.measures.MEASURES`.
    reference
        Keys of a study's table ``error``, such as ``{"kind": "finest"}``; by default the scene's reference.
    set
        Values by key that all runs share.
    **running
        As :class:`mpmfw.campaigns.running.Execution` takes them.

    Returns
    -------
    xarray.Dataset
        Over what varies: series (…, time, body | pair, axis), ``status``, costs (…[, stage]),
        ``cpu_time_repeat`` (…, repeat), ``load``; of each measure ``NAME`` (numbers alone) and ``NAME_error``
        (relative).

    Raises
    ------
    SceneError
        The request as a whole is wrong, or no point can run.
    """
    grid = make_grid({"": scene}, vary, dict(set or {}))
    return run_grid(grid, Execution.of(running), tuple(measures), reference)


def run_grid(
    grid: RunGrid,
    execution: Execution,
    measures: tuple[str, ...],
    reference: Mapping[str, Any] | None = None,
    *,
    threads: int = 1,
    grown: Callable[[xr.Dataset], None] | None = None,
) -> xr.Dataset:
    """Run and join all points of a grid, as :func:`campaign`; ``grown`` gets the dataset after each run."""
    if not grid.runnable:
        raise SceneError(problems=next(iter(grid.combinations.values())).problems)
    judges = judge_all(grid, measures, reference)
    runs = GridRuns(grid, "campaign", execution, threads=threads)

    def tell(event: Event) -> None:
        if execution.progress is not None:
            execution.progress(event)
        if grown is not None and event.name and event.status != "repeat":
            grown(dataset_of(runs, fields=False))

    runs.complete(progress=tell)
    runs.warn(lambda one: one.path)
    dataset = dataset_of(runs)
    if "fields" in dataset.attrs:
        warnings.warn(dataset.attrs["fields"], ResultsWarning, stacklevel=2)
    refusals = [status for status in dataset["status"].values.ravel() if status_code(status) == "refused"]
    if len(refusals) == dataset["status"].size:
        raise SceneError(refusals[0].removeprefix("refused: "))
    for measure, judge in judges:
        name, meaning = measure.name.replace("-", "_"), f"relative error of: {measure.meaning}"
        if measure.kind == "number":
            dataset[name] = runs.numbers(measure)
        if judge is not None:
            judged = judge.judge(runs.results, runs.succeeded())
            errors = {index: one.error for index, one in judged.items()}
            dataset[f"{name}_error"] = grid.array(errors, meaning, "1", against=judge.describe())
    return dataset


def dataset_of(runs: GridRuns, *, fields: bool = True) -> xr.Dataset:
    """Join series, status, costs and their conditions."""
    grid, costs = runs.grid, runs.costs()
    results = {index: runs.results(index) for index, _, _ in runs.known()}
    trees = {index: tree for index, tree in results.items() if tree is not None}
    status = grid.array(runs.statuses(), "ok, or why it is suspect or has no complete result")
    files = concatenate_runs(grid.coords, trees, fields=fields)
    dataset = xr.Dataset({"status": status, **files.data_vars}, files.coords, files.attrs)
    if keys := {dim: key for dim, key in grid.keys.items() if key not in ("contact", "shape")}:
        dataset.attrs["varied"] = json.dumps(keys)
    if notes := runs.notes(lambda one: one.path):
        dataset.attrs["notes"] = json.dumps(notes)
    each = costs_of(grid.coords, costs)
    cheapest = least(each)
    own = {name: cheapest[name].assign_attrs(dataset[name].attrs) for name, _, _ in COSTS if name in dataset}
    times = each["cpu_time"].assign_attrs(units="s", long_name="CPU time of each repeat")
    dataset = dataset.assign({**own, "cpu_time_repeat": times, **over_repeats(each)})
    return dataset.assign_attrs(runs.conditions())
