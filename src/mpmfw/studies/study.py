"""``mpmfw.study``: error and cost of a grid of methods and resolutions."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, Unpack, get_args

import xarray as xr

from mpmfw.campaigns.grid import RunGrid
from mpmfw.campaigns.grid import make_grid as make_points
from mpmfw.campaigns.grid_runs import GridRuns
from mpmfw.campaigns.judging import Judge
from mpmfw.campaigns.keys import overrides_of
from mpmfw.campaigns.measures import measure_of, outputs_for
from mpmfw.campaigns.running import Execution, Running
from mpmfw.codes.code import codes_of
from mpmfw.errors import Interrupted, NoSuchFileError, SceneError, SceneProblem
from mpmfw.results.replacing import check_replaceable, replace_dataset
from mpmfw.scene import Scene, load_scene
from mpmfw.scene.override import parse_value
from mpmfw.studies.dataset import assemble
from mpmfw.studies.loading import Study, load_study
from mpmfw.units import to_si

Timing = Literal["shared", "exclusive"]


def study(
    study: str | os.PathLike[str] | Mapping[str, Any] | Study,
    *,
    output: str | os.PathLike[str] | None = None,
    timing: Timing = "shared",
    under: float | str | None = None,
    code: Sequence[str] | None = None,
    trust: bool = False,
    about: Mapping[str, str] | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Run a grid of methods and resolutions, and put error and cost side by side.

    Parameters
    ----------
    study
        A TOML file, the name of a shipped study such as ``rolling-cylinder``, or nested mappings.
    output
        NetCDF file to write. Finished runs are kept in the folder ``<output>.runs``, from which an
        interrupted study continues.
    timing
        ``exclusive`` measures costs one run at a time in this process, ``shared`` while others run.
    under, about
        Replace the study's ``under``, such as 0.01 or ``"1 %"``, and its ``error.body``, ``pair`` and
        ``axis``.
    code
        Replaces the study's other codes; names as :func:`mpmfw.compare` takes them.
    **running
        As :class:`mpmfw.campaigns.running.Execution` takes them. Jobs are by default one for each core, for
        exclusive costs a single one.
    trust
        Import code that the files name as ``module:Class``.

    Returns
    -------
    xarray.Dataset
        Dims named by what varies. ``error`` (relative), ``cpu_time`` and ``cpu_time_spread`` [s],
        ``stage_time`` and ``settle_stage_time`` [s] (…, stage), ``pareto``, ``status``, ``timing`` …

    Raises
    ------
    SceneError
        The request is wrong: one line for each problem.
    """
    loaded = _with(load_study(study, trust), running.get("repeats"), under, about, code)
    if timing not in get_args(Timing):
        raise SceneError(f"timing: '{timing}' is unknown; expected one of {', '.join(get_args(Timing))}")
    path = None if output is None else Path(output)
    if path is not None:
        check_replaceable(path, "study")
    grid = make_grid(loaded)
    judge = Judge(loaded.tables.error, grid, loaded.at, loaded.beside)
    exclusive = timing == "exclusive"
    # One at a time from the start: what ran beside others would give no cost that counts
    alone = exclusive and running.get("executor") is None
    jobs = 1 if alone and running.get("jobs") is None else running.get("jobs")
    running["jobs"], running["repeats"] = jobs, loaded.tables.cost.repeats
    runs = GridRuns(grid, "study", Execution(**running), output=path, exclusive=exclusive)
    try:
        runs.complete()
    except Interrupted:
        if path is not None:  # what is known so far; the next start goes on from there
            replace_dataset(assemble(loaded, judge, runs), path)
        raise
    runs.warn()
    dataset = assemble(loaded, judge, runs)
    if path is not None:
        replace_dataset(dataset, path)
    return dataset


def _with(
    study: Study,
    repeats: int | None,
    under: float | str | None,
    about: Mapping[str, str] | None,
    code: Sequence[str] | None,
) -> Study:
    limit = None if under is None else relative_error(under)
    tables = study.tables
    cost = tables.cost if repeats is None else tables.cost.model_copy(update={"repeats": repeats})
    error = tables.error.model_validate(tables.error.model_dump() | dict(about or {}))
    update: dict[str, Any] = {"cost": cost, "error": error, **({} if under is None else {"under": limit})}
    update |= {} if code is None else {"code": list(code)}
    return replace(study, tables=tables.model_copy(update=update))


def relative_error(given: float | str, name: str = "under") -> float:
    """Return a relative error: a number below 1, or text with ``%``; a SceneError refuses others."""
    limit = positive(name, given, "1", "a relative error such as 0.01 or '1 %'")
    if limit >= 1.0 and "%" not in str(given):
        text = f"{name} {given}: is an error of {100.0 * limit:g} %"
        raise SceneError(f"{text}; expected '{given} %' or {limit / 100.0:g}")
    return limit


def positive(name: str, given: float | str, unit: str, expected: str) -> float:
    """Return a number above 0; a SceneError says what is ``expected``."""
    try:
        number = float(to_si(parse_value(given) if isinstance(given, str) else given, unit))  # type: ignore[arg-type]
    except (ValueError, TypeError) as error:
        reason = str(error).partition(";")[0]
        raise SceneError(f"{name}: {reason}; expected {expected}") from error
    if not number > 0.0:
        raise SceneError(f"{name}: must be greater than 0, not {given}")
    return number


def make_grid(study: Study) -> RunGrid:
    """Expand a study; refuse what no combination can run."""
    scenes = {label: _base(study, label, scene) for label, scene in study.scenes.items()}
    varied = dict(study.tables.vary)
    if study.tables.code:
        if "contact" not in varied:
            raise study.at(("vary",), "has no contact; codes are labels of that dimension")
        varied["contact"] = [*varied["contact"], *codes_of(study.tables.code)]
    grid = make_points(scenes, varied, {})
    _check(study, grid, varied)
    return grid


def _base(study: Study, label: str, chosen: Any) -> Scene:
    tables = study.tables
    shared: dict[str, Any] = dict(outputs_for(measure_of(tables.error.quantity)))
    try:
        scene = load_scene(chosen, trust=study.trust)
    except NoSuchFileError as error:
        raise study.at(("scenes", label) if label else ("scene",), str(error)) from error
    for key, value in tables.set.items():
        shared |= overrides_of(scene.bodies, scene.dim, key, value)
    try:
        return scene.with_overrides(shared)
    except SceneError as error:
        blamed = _blamed(error.problems[0], scene, tables.set)
        raise study.at(("set", blamed) if blamed else ("set",), error.problems[0].plain) from error


def _check(study: Study, grid: RunGrid, varied: Mapping[str, Sequence[Any]]) -> None:
    combinations = grid.combinations
    first = next(iter(combinations.values()))
    if not grid.runnable:
        scene = next(iter(grid.scenes.values()))
        key = _blamed(first.problems[0], scene, {key: values[0] for key, values in varied.items()})
        raise study.at(("vary", key) if key else ("vary",), first.why)
    offset = 1 if study.tables.scenes else 0
    for depth, (key, values) in enumerate(varied.items()):
        for k in range(len(values)):
            with_it = [one for index, one in combinations.items() if index[depth + offset] == k]
            if all(one.scene is None for one in with_it):
                raise study.at(("vary", key, k), with_it[0].why)


def _blamed(problem: SceneProblem, scene: Scene, values: Mapping[str, Any]) -> str | None:
    for key, value in values.items():
        if problem.override in overrides_of(scene.bodies, scene.dim, key, value):
            return key
    return None
