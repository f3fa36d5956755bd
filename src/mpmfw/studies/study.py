"""``mpmfw.study``: what accuracy costs in time."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, get_args

import xarray as xr

from mpmfw.errors import MpmfwError, ResultsWarning, SceneError
from mpmfw.results.replacing import check_replaceable, replace_dataset
from mpmfw.studies.cluster import Cluster
from mpmfw.studies.dataset import assemble
from mpmfw.studies.executors import Executor, InProcess, Pool, cores
from mpmfw.studies.grid import Grid, Index, make_grid
from mpmfw.studies.identity import key_of
from mpmfw.studies.judging import Judge
from mpmfw.studies.loading import Study, load_study
from mpmfw.studies.schedule import Progress, complete, wanted
from mpmfw.studies.store import Record, Store

Timing = Literal["shared", "exclusive"]


def study(
    study: str | os.PathLike[str] | Mapping[str, Any] | Study,
    *,
    output: str | os.PathLike[str] | None = None,
    timing: Timing = "shared",
    jobs: int | None = None,
    scheduler: str | None = None,
    repeats: int | None = None,
    under: float | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run a grid of methods and resolutions, and put error and cost side by side.

    Parameters
    ----------
    study
        A TOML file, the name of a shipped study such as ``rolling-cylinder``, or nested mappings.
    output
        NetCDF file to write; it replaces nothing but another study's. Finished runs are kept in the folder
        ``<output>.runs`` beside it, from which a study that was broken off, or changed, takes what still applies.
        Without it nothing is kept.
    timing
        ``exclusive`` measures costs one run at a time in this process, after all results are there; ``shared`` takes
        the cost of every run as it comes.
    jobs
        Processes at a time, one thread each: 1 is this process itself, None one for each core. A script that starts
        processes needs its ``if __name__ == "__main__":``.
    scheduler
        Address of a Dask scheduler, such as ``tcp://127.0.0.1:8786``, whose workers run the study instead.
    repeats, under
        Stand in for the study's ``cost.repeats`` and ``under`` (relative error).
    progress
        Called with an :class:`mpmfw.studies.schedule.Event` at the start and after every run.

    Returns
    -------
    xarray.Dataset
        Dims named by what varies. ``error`` (relative; NaN where unknown), ``cpu_time`` and ``cpu_time_spread`` [s],
        ``stage_time`` and ``settle_stage_time`` [s] (…, stage), ``pareto`` (true on the front), ``status``, ``timing``,
        ``repeats``, steps, material_points, peak_memory [B] …

    Raises
    ------
    SceneError
        The request is wrong: one line for each problem.
    MpmfwError
        A file cannot be written, or no scheduler's worker does its work.

    Notes
    -----
    A run that fails is recorded, and does not stop the others.
    """
    loaded = _with(load_study(study), repeats, under)
    if timing not in get_args(Timing):
        raise SceneError(f"timing: '{timing}' is unknown; expected one of {', '.join(get_args(Timing))}")
    path = None if output is None else _writable(Path(output))
    grid = make_grid(loaded)
    judge = Judge(loaded, grid)
    executor = _executor(jobs, scheduler)
    exclusive = timing == "exclusive"
    with _store(path) as store:
        keys = {i: key_of(one.scene) for i, one in grid.combinations.items() if one.scene is not None}
        try:
            complete(wanted(grid), store, executor, loaded.tables.cost.repeats, exclusive, progress)
        except KeyboardInterrupt:
            if path is not None:  # what is known so far; the next start goes on from there
                replace_dataset(_dataset(loaded, grid, judge, store, keys, exclusive), path)
            raise
        dataset = _dataset(loaded, grid, judge, store, keys, exclusive)
    if path is not None:
        replace_dataset(dataset, path)
    return dataset


def _with(study: Study, repeats: int | None, under: float | None) -> Study:
    """The study with the request's own values of some keys."""
    if repeats is not None and repeats < 1:
        raise SceneError(f"repeats: must be at least 1, not {repeats}")
    if under is not None and not under > 0.0:
        raise SceneError(f"under: must be greater than 0, not {under:g}")
    tables = study.tables
    cost = tables.cost if repeats is None else tables.cost.model_copy(update={"repeats": repeats})
    update = {"cost": cost, **({} if under is None else {"under": under})}
    return replace(study, tables=tables.model_copy(update=update))


def _executor(jobs: int | None, scheduler: str | None) -> Executor:
    if scheduler is not None:
        if jobs is not None:
            raise SceneError("jobs: has no effect with a scheduler, whose workers are as many as they are")
        return Cluster(scheduler)
    if jobs is not None and jobs < 1:
        raise SceneError(f"jobs: must be at least 1, not {jobs}")
    return InProcess() if (jobs or cores()) == 1 else Pool(jobs)


def _dataset(
    study: Study, grid: Grid, judge: Judge, store: Store, keys: Mapping[Index, str], exclusive: bool
) -> xr.Dataset:
    records: dict[Index, Record | None] = {
        index: store.record(keys[index]) if index in keys else None for index in grid.combinations
    }
    succeeded = {index: record is not None and record.status == "ok" for index, record in records.items()}
    judgements = judge.judge(lambda index: store.results(keys[index]), succeeded)
    for index, record in records.items():
        for note in record.notes if record is not None else ():
            warnings.warn(f"{grid.combinations[index].name}: {note}", ResultsWarning, stacklevel=3)
    return assemble(study, grid, judge, records, judgements, exclusive)


@contextmanager
def _store(path: Path | None) -> Iterator[Store]:
    """The folder of finished runs beside the output; one that is thrown away without an output."""
    if path is not None:
        yield Store(path.with_name(f"{path.name}.runs"))
        return
    with tempfile.TemporaryDirectory(prefix="mpmfw-study-") as folder:
        yield Store(folder)


def _writable(path: Path) -> Path:
    """Say before the first run that the output cannot be written."""
    folder = path.parent
    if not folder.is_dir():
        raise MpmfwError(f"cannot create '{path}': there is no folder '{folder}'")
    if not os.access(folder, os.W_OK) or path.is_dir():
        raise MpmfwError(f"cannot create '{path}': not writable")
    check_replaceable(path, "study", "study's results")
    return path
