"""Error and cost of all combinations as one dataset, the Pareto front marked."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from mpmfw.campaigns.grid import Index, RunGrid
from mpmfw.campaigns.grid_runs import GridRuns, costs_of, least, over_repeats, timing_of
from mpmfw.campaigns.judging import Judge
from mpmfw.campaigns.measures import measure_of
from mpmfw.campaigns.store import COSTS, Cost
from mpmfw.codes.code import Code
from mpmfw.plugin.discovery import load
from mpmfw.results.concatenation import STEPPING
from mpmfw.results.provenance import provenance
from mpmfw.state.fields import FloatArray
from mpmfw.studies.loading import Study

#: What a study says of every run beside its error, whatever that is of, and the measure of each.
BESIDE = {
    "noise": "force-noise",
    "penetration": "penetration",
    "energy": "energy-error",
    "dissipation": "dissipation",
    "momentum": "momentum-change",
}


def assemble(study: Study, judge: Judge, runs: GridRuns) -> xr.Dataset:
    """Join all combinations, as :func:`mpmfw.study` returns them."""
    grid, costs = judge.grid, runs.costs()
    dataset = xr.Dataset(coords={dim: list(labels) for dim, labels in grid.coords.items()})
    dataset = dataset.assign_coords(_methods(grid))
    dataset = dataset.assign(_errors(judge, runs))
    dataset = dataset.assign(_costs(grid, costs, study.tables.cost.settling))
    dataset = dataset.assign(_stepping(grid))
    for name, of in BESIDE.items():
        dataset[name] = runs.numbers(measure_of(of))
    dataset["status"] = grid.array(runs.statuses(), "ok, or why it is suspect or has no result")
    marks = {index: timing_of(costs.get(index, ())) for index in grid.combinations}
    dataset["timing"] = grid.array(marks, "whether other runs of the study shared the cores meanwhile")
    dataset["pareto"] = _front(grid, dataset)
    dataset.attrs = _attributes(study, judge, runs) | runs.conditions()
    return dataset


def _methods(grid: RunGrid) -> dict[str, Any]:
    methods = {
        "contact": {s.contact.method if s.contact else "none" for s in grid.scenes.values()},
        "shape": {scene.shape.method for scene in grid.scenes.values()},
    }
    single = {name: chosen.pop() for name, chosen in methods.items() if len(chosen) == 1}
    return {name: label for name, label in single.items() if name not in grid.coords}


def _stepping(grid: RunGrid) -> dict[str, xr.DataArray]:
    chosen: dict[Index, tuple[str, ...]] = {}
    for index, scene in grid.runnable.items():
        contact = grid.combinations[index].contact
        own = (*scene.stepping.chosen(load("shape", scene.shape.method)), "")
        chosen[index] = ("", "", contact.title) if isinstance(contact, Code) else own
    return {
        name: grid.array({index: words[k] for index, words in chosen.items()}, meaning)
        for k, (name, meaning) in enumerate(STEPPING)
        if name not in grid.coords and any(words[k] for words in chosen.values())
    }


def _errors(judge: Judge, runs: GridRuns) -> dict[str, xr.DataArray]:
    grid, measure, judged = judge.grid, judge.measure, judge.judge(runs.complete_results)
    shown = {"error": (f"relative error of: {measure.meaning}", "1")}
    if measure.kind == "number":
        shown |= {
            "value": (measure.meaning, measure.unit),
            "expected": ("its reference value", measure.unit),
        }
    return {
        name: grid.array({i: getattr(one, name) for i, one in judged.items()}, meaning, unit)
        for name, (meaning, unit) in shown.items()
    }


def _costs(grid: RunGrid, costs: Mapping[Index, list[Cost]], settling: bool) -> dict[str, xr.DataArray]:
    """Return costs of the cheapest repeat, with or without settling."""
    each = costs_of(grid.coords, costs)
    what = "CPU time of the steps" + (" and of settling" if settling else "")
    if settling:
        each = each.assign(
            cpu_time=each["cpu_time"] + each["settle_time"],
            stages=each["stages"] + each["settling"],
            steps=each["steps"] + each["settle_steps"],
        )
    message = {name: {"units": unit, "long_name": meaning} for name, unit, meaning in COSTS}
    message["cpu_time"]["long_name"] = f"{what}, without compilation and output; least of the repeats"
    message["steps"]["long_name"] += ", those of settling included" if settling else ""
    stages = {
        "stage_time": ("stages", f"{what} by stage, in the cheapest repeat"),
        "settle_stage_time": ("settling", "CPU time of settling by stage, in the cheapest repeat"),
    }
    one = least(each)
    return {
        **{name: one[name].assign_attrs(attributes) for name, attributes in message.items()},
        **{name: one[of].assign_attrs(units="s", long_name=text) for name, (of, text) in stages.items()},
        **over_repeats(each),
    }


def _front(grid: RunGrid, dataset: xr.Dataset) -> xr.DataArray:
    inner = [dim for dim in grid.coords if dim not in grid.problem_dims]
    marked: xr.DataArray = xr.apply_ufunc(
        front,
        dataset["error"].where(dataset["status"] == "ok"),
        dataset["cpu_time"],
        input_core_dims=[inner, inner],
        output_core_dims=[inner],
        vectorize=True,
        keep_attrs=False,
    )
    meaning = "no other run of the problem has a smaller error at no larger CPU time"
    return marked.transpose(*grid.coords).assign_attrs(long_name=meaning)


def _attributes(study: Study, judge: Judge, runs: GridRuns) -> dict[str, Any]:
    tables, grid = study.tables, judge.grid
    notes, versions = runs.notes(), provenance()
    return {
        "kind": "study",
        "title": tables.title or study.name,
        "study": study.source.text or json.dumps(study.source.mapping, default=str),
        "scenes": json.dumps({label or scene.name: scene.text for label, scene in grid.scenes.items()}),
        "quantity": judge.measure.name,
        "about": json.dumps({key: name for key, name in asdict(judge.about).items() if name is not None}),
        "error_kind": tables.error.kind,
        "error_norm": "" if judge.measure.kind == "number" else judge.norm,
        "error_against": judge.describe(),
        "under": float(tables.under),
        "varied": json.dumps(dict(grid.keys)),
        "problem_dims": json.dumps(grid.problem_dims),
        "versions": json.dumps(versions["versions"]),
        **({"commit": versions["commit"]} if "commit" in versions else {}),
        **({"notes": json.dumps(notes)} if notes else {}),
    }


def front(error: FloatArray, cost: FloatArray) -> NDArray[np.bool_]:
    """Mark runs that no other one dominates, with smaller error or cost and neither larger; NaN never is."""
    pairs = np.stack([np.ravel(cost), np.ravel(error)], axis=1)
    known = np.isfinite(pairs).all(axis=1)
    different, place = np.unique(pairs[known], axis=0, return_inverse=True)  # by rising cost, then error
    cheaper = np.minimum.accumulate(np.append(np.inf, different[:-1, 1]))  # least error of those before
    on = np.zeros(known.shape, dtype=bool)
    on[known] = (different[:, 1] < cheaper)[np.ravel(place)]
    return on.reshape(np.shape(error))
