"""``mpmfw.campaign`` and ``mpmfw.compare``: a grid of runs as one dataset."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Unpack

import xarray as xr

from mpmfw.campaigns.grid import RunGrid, given_twice, labels_of, make_grid
from mpmfw.campaigns.grid_runs import GridRuns, costs_of, least, over_repeats
from mpmfw.campaigns.judging import judge_all
from mpmfw.campaigns.measures import exact_of, measure_of, names_of_measures
from mpmfw.campaigns.running import Event, Execution, Running
from mpmfw.campaigns.store import COSTS, store_of
from mpmfw.codes.code import codes_of
from mpmfw.errors import Interrupted, ResultsWarning, SceneError, is_complete, status_code
from mpmfw.plugin.discovery import Kind, object_of
from mpmfw.plugin.measure import About
from mpmfw.results.concatenation import concatenate_runs
from mpmfw.results.references import RingsReference, RollingReference, declared
from mpmfw.results.replacing import check_replaceable, replace_dataset
from mpmfw.scene import Scene, load_scene
from mpmfw.scene.requested import check_compared, methods_of
from mpmfw.scene.sources import plain
from mpmfw.scene.specification import written


def campaign(
    scene: Any,
    vary: Mapping[str, Sequence[Any]],
    *,
    measures: Iterable[str] = (),
    reference: Mapping[str, Any] | None = None,
    set: Mapping[str, Any] | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Run a scene at all points of a grid, and join the results.

    Parameters
    ----------
    scene
        A file, the name of a shipped scene, or a mapping.
    vary
        Values by key: ``contact`` and ``shape`` (names, names with options, configured strategy objects),
        short names such as ``cell_size``, or dotted keys of the scene. A dimension each, in this order.
    measures
        Names of quantities to measure in every run, see :data:`mpmfw.campaigns.measures.MEASURES`.
    reference
        Keys of a study's table ``error``, such as ``{"kind": "finest"}``; by default the scene's reference.
    set
        Values by key that all runs share.
    **running
        As :class:`mpmfw.campaigns.running.Execution` takes them.

    Returns
    -------
    xarray.Dataset
        Over the varied dimensions: series (…, time, body | pair, axis), ``status``, costs (…[, stage]),
        ``cpu_time_repeat`` (…, repeat), ``load``; for each measure ``NAME`` (if a number) and ``NAME_error``
        (relative).

    Raises
    ------
    SceneError
        The request as a whole is wrong, or no point can run.
    """
    grid = make_grid({"": scene}, vary, dict(set or {}))
    return run_grid(grid, Execution(**running), tuple(measures), reference)


def run_grid(
    grid: RunGrid,
    execution: Execution,
    measures: tuple[str, ...],
    reference: Mapping[str, Any] | None = None,
    *,
    threads: int = 1,
    partial: Callable[[xr.Dataset], None] | None = None,
) -> xr.Dataset:
    """Run and join all points of a grid, as :func:`campaign`; call ``partial`` with the dataset of the first
    complete run, and of all that have ended where they are interrupted."""
    if not grid.runnable:
        raise SceneError(problems=next(iter(grid.combinations.values())).problems)
    judges = judge_all(grid, measures, reference)
    runs, waits = GridRuns(grid, "campaign", execution, threads=threads), True

    def tell(event: Event) -> None:
        nonlocal waits
        if partial is not None and waits and is_complete(event.status):
            partial(dataset_of(runs, fields=False))
            waits = False
        if execution.progress is not None:
            execution.progress(event)

    try:
        runs.complete(progress=tell)
    except Interrupted:
        if partial is not None and not waits:
            partial(dataset_of(runs, fields=False))
        raise
    runs.warn()
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
            judged = judge.judge(runs.complete_results)
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
    if notes := runs.notes():
        dataset.attrs["notes"] = json.dumps(notes)
    each = costs_of(grid.coords, costs)
    cheapest = least(each)
    own = {name: cheapest[name].assign_attrs(dataset[name].attrs) for name, _, _ in COSTS if name in dataset}
    times = each["cpu_time"].assign_attrs(units="s", long_name="CPU time of each repeat")
    dataset = dataset.assign({**own, "cpu_time_repeat": times, **over_repeats(each)})
    return dataset.assign_attrs(runs.conditions())


def compare(
    scene: Any,
    contact: Sequence[Any] | None = None,
    shape: Sequence[Any] | None = None,
    vary: Mapping[str, Sequence[Any]] | None = None,
    *,
    code: Sequence[Any] = (),
    output: str | os.PathLike[str] | None = None,
    set: Mapping[str, Any] | None = None,
    measures: Iterable[str] | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Run a scene with every combination of contact and shape (and varied keys) and join the results.

    Parameters
    ----------
    scene
        A file, the name of a shipped scene, or a mapping.
    contact, shape
        Methods, each once, by default the scene's: names with or without options, such as
        ``"penalty(kappa=2)"``, ``"module:Class"``, strategy objects or their classes. Options beside a name
        override those of the scene.
    vary
        Scene keys and their values, such as ``{"grid.cell_size": [0.4, 0.2]}``; the key's last part names the
        dimension.
    code
        Other codes, each a label of the dimension ``contact``: names with or without options, or adapters. A
        bare name stands for a code's plainest and its best settings. A code runs once, whatever the shape.
    output
        NetCDF file to write, with the first run as soon as that has ended, and at an interruption. Finished
        runs are kept in the folder ``<output>.runs``, from which an interrupted comparison continues.
    set
        Scene keys that all runs share. ``output.particles`` keeps fields if all runs have the same points.
    measures
        As in :func:`mpmfw.campaign`; by default those for which the scene has an exact value.
    **running
        As :class:`mpmfw.campaigns.running.Execution` takes them.

    Returns
    -------
    xarray.Dataset
        Series with dims (contact, shape, *vary, time, body | pair, axis), costs with dims (contact, shape,
        *vary[, stage]), ``status`` ("ok", "suspect: …", "failed: …" or "refused: …"). A failing method does
        not stop the others; its values are NaN after the failure.

    Raises
    ------
    SceneError
        The request as a whole is wrong, no combination can run, or the output is a file of another kind.
    """
    own = methods_of(load_scene(scene, set=set or {})) if contact is None or shape is None else {}
    methods = {
        "contact": own["contact"] if contact is None else _checked("contact", contact, "contact"),
        "shape": own["shape"] if shape is None else _checked("shape", shape, "shape"),
    }
    varied = dict(vary or {})
    check_compared(scene, methods, set or {}, varied)
    codes = codes_of(code)
    methods["contact"] += codes
    for key, values in varied.items():
        _checked(f"vary {key}", values)
    if output is not None:
        check_replaceable(output, "compare")
    path = None if output is None else os.path.abspath(output)
    first = _first(scene, methods, set or {})
    known = _applicable_measures(first) if measures is None else list(measures)
    # The scene's own word counts; one that says nothing has material points where a measure reads them
    said = first is not None and "particles" in first.output.model_fields_set
    particles = {} if said else {"output.particles": any(measure_of(name).particles for name in known)}

    def partial(dataset: xr.Dataset) -> None:
        if path is not None:
            _write(dataset, path)

    if running.get("store") is None:
        running["store"] = store_of(path)
    grid = make_grid({"": scene}, {**methods, **varied}, {**particles, **(set or {})})
    threads = 1 if first is None else first.threads
    dataset = run_grid(grid, Execution(**running), tuple(known), threads=threads, partial=partial)
    dataset.attrs["set"] = json.dumps(plain(set or {}), default=str)
    dataset.attrs["codes"] = json.dumps({one.label: one.title for one in codes})
    if path is not None:
        _write(dataset, path)
    return dataset


def _first(scene: Any, methods: Mapping[str, Sequence[Any]], shared: Mapping[str, Any]) -> Scene | None:
    named = {f"{kind}.method": chosen[0] for kind, chosen in methods.items() if isinstance(chosen[0], str)}
    try:
        return load_scene(scene, set={**shared, **named})
    except SceneError:
        return None


def _applicable_measures(scene: Scene | None) -> list[str]:
    if scene is None:
        return []
    try:
        if isinstance(declared(scene), RollingReference | RingsReference):
            return []
        measures = [measure_of(name) for name in names_of_measures()]
        kept = scene.output.particles or "particles" not in scene.output.model_fields_set
        return [
            one.name
            for one in measures
            if one.kind != "curve"
            and (kept or not one.particles)
            and exact_of(one, scene, About()) is not None
        ]
    except SceneError as error:
        warnings.warn(f"no errors are measured: {error}", ResultsWarning, stacklevel=3)
        return []


def _write(dataset: xr.Dataset, path: str) -> None:
    packed = dataset.copy()
    for array in packed.data_vars.values():
        array.encoding = {"zlib": True, "complevel": 1} if array.dtype.kind == "f" else {}
    replace_dataset(packed, path)


def _checked(name: str, values: Any, kind: Kind | None = None) -> list[Any]:
    """Return values, each once; of a ``kind`` methods as labels write them, and objects of classes."""
    if isinstance(values, str) or not hasattr(values, "__len__") or len(values) == 0:
        raise SceneError(f"{name}: expected a list of at least one value, got {values!r}")
    if kind is not None:
        values = [written(kind, one, kind) if isinstance(one, str) else object_of(one) for one in values]
    for k in given_twice(values):
        raise SceneError(f"{name}: {labels_of([values[k]])[0]} is given twice")
    return list(values)
