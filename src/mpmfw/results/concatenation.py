"""Join the trees of several runs into one dataset, with NaN where a run has no value."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.results.domains import loops
from mpmfw.results.reading import output_times
from mpmfw.results.selection import same_points
from mpmfw.state.fields import COSTS, STAGES, AnyArray, FloatArray

#: Root attributes of a run that are words: two that ``auto`` leaves to the shape function, and another code.
STEPPING: tuple[tuple[str, str], ...] = (
    ("scheme", "order of the step"),
    ("transfer", "between points and grid"),
    ("code", "other code that ran it: version, float width and processor"),
)

#: Attributes that differ between the runs of a comparison, and costs.
_OF_ONE_RUN = {"contact", "shape", "effects", "plugins", "status", "kind", "surface_nodes"}
_COSTS = {name for name, _, _ in COSTS}
_COSTS |= {f"{clock}_{stage}" for clock in ("cpu", "wall", "settle_cpu") for stage in STAGES}

Index = tuple[int, ...]


def concatenate_runs(
    coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree], *, fields: bool = True
) -> xr.Dataset:
    """Join the runs of a grid along new dimensions with the values ``coords``; ``trees`` are by index.

    ``fields`` adds the fields of material points as ``particle_<name>``. If they cannot be joined, the
    attribute ``fields`` gives the reason.
    """
    shape = tuple(len(values) for values in coords.values())
    joined: dict[str, Any] = {}
    for name, meaning in STEPPING:
        words = np.full(shape, "", dtype=object)
        for index, tree in trees.items():
            words[index] = str(tree.attrs.get(name, ""))
        if name not in coords and words.any():
            joined[name] = xr.DataArray(words, dims=tuple(coords), attrs={"long_name": meaning})
    other = _other_points(coords, trees) if fields else ""
    runs = {index: _costs(trees.get(index)) for index in np.ndindex(*shape)}
    for index, tree in trees.items():
        series = series_at_outputs(tree)
        parts = [series.transpose("time", ...) if "time" in series.coords else series, *_outlines(tree)]
        if fields and not other and "particles" in tree.children:
            parts.append(_points(tree))
        for part in parts:
            runs[index] = runs[index].assign(part.data_vars).assign_coords(part.coords)
    runs = _aligned(runs)
    joined |= over_grid(coords, runs)
    dataset = xr.Dataset(joined, {name: list(values) for name, values in coords.items()})
    bodies = [run["particle_body"] for run in runs.values() if "particle_body" in run.coords]
    if bodies:
        dataset = dataset.assign_coords(particle_body=bodies[0])
    attributes = _attributes(coords, trees) | ({"fields": other} if other else {})
    return dataset.drop_vars("outline_node", errors="ignore").assign_attrs(attributes)


def over_grid(
    coords: Mapping[str, Sequence[Any]], runs: Mapping[Index, xr.Dataset]
) -> dict[str, xr.DataArray]:
    """Return arrays of aligned runs over the grid, NaN for missing runs."""
    shape, joined = tuple(len(values) for values in coords.values()), {}
    for index, data in runs.items():
        for name, one in data.data_vars.items():
            if name not in joined:
                own = {dim: one.coords[dim] for dim in one.dims if dim in one.coords}
                empty = np.full((*shape, *one.shape), np.nan, one.dtype if one.dtype.kind == "f" else float)
                joined[str(name)] = xr.DataArray(empty, own, (*coords, *one.dims), attrs=one.attrs)
            joined[str(name)].values[index] = one.values
    return joined


def _aligned(runs: dict[Index, xr.Dataset]) -> dict[Index, xr.Dataset]:
    for dim in dict.fromkeys(dim for run in runs.values() for dim in run.indexes):
        labels = [run[dim].values for run in runs.values() if dim in run.indexes]
        if all(np.array_equal(one, labels[0]) for one in labels):
            continue
        options: dict[str, Any] = {}
        every: Any = list(dict.fromkeys(label for one in labels for label in one.tolist()))
        if str(dim).endswith("time"):
            every = union_of_times(labels)
            options = {"method": "nearest", "tolerance": 2e-9 * np.ptp(every)}
        runs = {
            index: run.reindex({dim: every}, **options) if dim in run.indexes else run
            for index, run in runs.items()
        }
    return runs


def _attributes(coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree]) -> dict[str, Any]:
    """Keep attributes that all runs share; ``methods`` holds the others."""
    runs = {
        "/".join(_labels(coords, index)): {
            str(name): value for name, value in tree.attrs.items() if name not in _COSTS
        }
        for index, tree in trees.items()
    }
    first = next(iter(runs.values()), {})
    common = {
        name: value
        for name, value in first.items()
        if name not in _OF_ONE_RUN and all(str(run.get(name)) == str(value) for run in runs.values())
    }
    left_out = {*common, "scene", "kind", "status"}
    methods = {
        label: {name: value for name, value in run.items() if name not in left_out}
        for label, run in runs.items()
    }
    scene = {"scene": first["scene"]} if "scene" in first else {}
    text = json.dumps(methods, default=lambda one: one.item() if isinstance(one, np.generic) else str(one))
    return {**common, **scene, "kind": "compare", "methods": text}


def union_of_times(times: Sequence[FloatArray]) -> FloatArray:
    """Return the sorted union of times, equal up to round-off."""
    together = np.unique(np.concatenate(times))
    if len(together) < 2:
        return together
    new = np.diff(together, prepend=-np.inf) > 1e-9 * (together[-1] - together[0])
    return np.asarray(together[new])


def series_at_outputs(tree: xr.DataTree) -> xr.Dataset:
    """Return the series of a run at the multiples of its output interval.

    Series are linear between records and means are constant. Integers come from the nearest record.
    """
    series, times = tree["series"].to_dataset(), output_times(tree)
    if tree.attrs.get("outputs", "exact") == "exact" or times.size < 2:
        return series
    recorded: FloatArray = np.asarray(times.values, dtype=np.float64)
    interval = float(tree.attrs["output_interval"])
    outputs: FloatArray = interval * np.arange(int(recorded[-1] / interval + 1e-9) + 1.0)
    if recorded[-1] - outputs[-1] > 1e-9 * recorded[-1]:  # the last output is the end of the run
        outputs = np.append(outputs, recorded[-1])
    known = {}
    for name, array in series.transpose("time", ...).data_vars.items():
        mean = str(array.attrs.get("cell_methods", "")) == "time: mean"
        known[name] = (array.dims, _at(recorded, array.values, outputs, mean=mean), array.attrs)
    coords = {name: coord for name, coord in series.coords.items() if name != "time"}
    return xr.Dataset(known, {**coords, "time": ("time", outputs, times.attrs)})


def _at(recorded: FloatArray, values: AnyArray, outputs: FloatArray, *, mean: bool) -> AnyArray:
    """Return values (recorded, …) at the outputs, (outputs, …)."""
    column = (-1, *[1] * (values.ndim - 1))
    if mean:
        means = np.diff(recorded).reshape(column) * values[1:]
        integral = np.concatenate([np.zeros_like(values[:1]), np.cumsum(means, axis=0)])
        between = np.diff(_at(recorded, integral, outputs, mean=False), axis=0)
        return np.concatenate([values[:1], between / np.diff(outputs).reshape(column)])
    place = np.interp(outputs, recorded, np.arange(len(recorded)))
    if np.array_equal(values, np.round(values), equal_nan=True):
        place = np.round(place)
    before = place.astype(int)
    share = (place - before).reshape(column)
    return np.asarray(
        (1.0 - share) * values[before] + share * values[np.minimum(before + 1, len(values) - 1)]
    )


def _other_points(coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree]) -> str:
    """Return the reason why fields cannot be joined, if the material points of two runs differ."""
    kept = {index: tree["particles"] for index, tree in trees.items() if "particles" in tree.children}
    for index, others in kept.items():
        first, points = next(iter(kept.items()))
        same = list(others.children) == list(points.children) and all(
            same_points(group.to_dataset(), points[body].to_dataset())
            for body, group in others.children.items()
        )
        if not same:
            runs = " and ".join(", ".join(_labels(coords, one)) for one in (first, index))
            why = f"{runs} have different material points; run them one by one to draw them"
            return f"fields are not joined: {why}"
    return ""


def _labels(coords: Mapping[str, Sequence[Any]], index: Index) -> list[str]:
    return [str(values[i]) for values, i in zip(coords.values(), index, strict=True)]


def _points(tree: xr.DataTree) -> xr.Dataset:
    """Return the fields of all bodies, one after the other."""
    parts = []
    for body, node in tree["particles"].children.items():
        group = node.to_dataset()
        fields = group[[name for name, array in group.data_vars.items() if "particle" in array.dims]]
        parts.append(fields.assign_coords(particle_body=("particle", [body] * group.sizes["particle"])))
    points = xr.concat(
        parts, "particle", data_vars="all", coords="minimal", compat="override", combine_attrs="override"
    )
    times = points["time"].values
    if tree.attrs.get("outputs", "exact") != "exact":
        interval = float(tree.attrs["output_interval"])
        times = np.append(interval * np.round(times[:-1] / interval), times[-1:])
    names = {name: f"particle_{name}" for name in points.data_vars}
    points = points.rename({**names, "time": "particle_time"})
    return points.assign_coords(particle_time=("particle_time", times, {"units": "s"}))


def _costs(tree: xr.DataTree | None) -> xr.Dataset:
    def cost(name: str) -> float:
        return float("nan" if tree is None else tree.attrs.get(name, "nan"))

    costs: dict[str, Any] = {
        name: ((), cost(name), {"units": unit, "long_name": meaning}) for name, unit, meaning in COSTS
    }
    for clock, word in (("cpu", "CPU"), ("wall", "wall")):
        attributes = {"units": "s", "long_name": f"{word} time by stage of the step"}
        costs[f"{clock}_stage"] = ("stage", [cost(f"{clock}_{stage}") for stage in STAGES], attributes)
    return xr.Dataset(costs, {"stage": list(STAGES)})


def _outlines(tree: xr.DataTree) -> list[xr.Dataset]:
    """Return first and last outlines as closed polylines, separated by NaN."""
    lines = []
    for body, node in tree["surface"].children.items() if "surface" in tree.children else ():
        surface = node.to_dataset()
        if not {"position", "next"} <= surface.keys() or surface.sizes.get("time", 0) == 0:
            continue
        ends = surface["position"].values[[0, -1]]
        parted = np.full((2, 1, ends.shape[2]), np.nan)
        line = np.concatenate(
            [part for loop in loops(surface["next"].values) for part in (ends[:, loop], parted)], axis=1
        )
        labels = {"frame": ["first", "last"], "outline_node": range(line.shape[1]), "axis": ["x", "y"]}
        lines.append(xr.DataArray(line, labels, tuple(labels)).expand_dims(outlined_body=[body], axis=1))
    if not lines:
        return []
    meaning = "surface of the body at the first and last output; NaN separates its loops"
    outline = xr.concat(lines, "outlined_body", join="outer")
    times = tree["series"].coords["time"].values[[0, -1]]
    return [
        xr.Dataset(
            {
                "outline": outline.assign_attrs(units="m", long_name=meaning),
                "outline_time": ("frame", times, {"units": "s", "long_name": "time of the outline"}),
            }
        )
    ]
