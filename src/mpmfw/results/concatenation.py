"""Join the trees of several runs into one dataset, NaN where a run has nothing."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.results.domains import loops
from mpmfw.results.reading import output_times
from mpmfw.results.selection import same_points
from mpmfw.state.clock import COSTS, STAGES
from mpmfw.state.fields import AnyArray, FloatArray

#: Root attributes of a run that ``auto`` leaves to the shape function.
STEPPING: tuple[tuple[str, str], ...] = (
    ("scheme", "order of the step"),
    ("transfer", "between points and grid"),
)

#: Attributes that differ between the runs of a comparison and say nothing of the whole.
_OF_ONE_RUN = {"contact", "shape", "effects", "plugins", "status", "kind", "surface_nodes"}

Index = tuple[int, ...]


def concatenate_runs(
    coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree], *, fields: bool = True
) -> xr.Dataset:
    """Join the runs of a grid over new dimensions, whose values are ``coords``; ``trees`` are by index.

    The dataset has scheme and transfer, as far as they are known and not varied; series, costs, costs by
    stage, first and last outlines, and, with ``fields``, those of material points as ``particle_<name>``.
    Where material points differ, the attribute ``fields`` says so.
    """
    shape = tuple(len(values) for values in coords.values())
    joined: dict[str, Any] = {}
    for name, meaning in STEPPING:
        words = np.full(shape, "", dtype=object)
        for index, tree in trees.items():
            words[index] = str(tree.attrs.get(name, ""))
        if name not in coords and words.any():
            joined[name] = xr.DataArray(words, dims=tuple(coords), attrs={"long_name": meaning})
    joined |= over_grid(coords, _series(trees))
    joined |= over_grid(coords, {index: _costs(trees.get(index)) for index in np.ndindex(*shape)})
    joined |= over_grid(coords, _outlines(trees))
    dataset = xr.Dataset(joined, {name: list(values) for name, values in coords.items()})
    dataset = dataset.assign_attrs(_attributes(coords, trees))
    return _with_fields(dataset, coords, trees) if fields else dataset


def over_grid(
    coords: Mapping[str, Sequence[Any]], runs: Mapping[Index, xr.Dataset]
) -> dict[str, xr.DataArray]:
    """Return numbers of runs, which have the same coordinates, with the dimensions of the grid before their
    own; NaN where none are.
    """
    shape, joined = tuple(len(values) for values in coords.values()), {}
    for index, data in runs.items():
        for name, one in data.data_vars.items():
            if name not in joined:
                own = {dim: one.coords[dim] for dim in one.dims if dim in one.coords}
                empty = np.full((*shape, *one.shape), np.nan, one.dtype if one.dtype.kind == "f" else float)
                joined[str(name)] = xr.DataArray(empty, own, (*coords, *one.dims), attrs=one.attrs)
            joined[str(name)].values[index] = one.values
    return joined


def _attributes(coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree]) -> dict[str, Any]:
    """Keep what all runs share and the first one's scene; ``methods`` holds what differs, run by run."""
    own = {name for name, _, _ in COSTS} | {
        f"{clock}_{stage}" for clock in ("cpu", "wall", "settle_cpu") for stage in STAGES
    }
    runs = {
        "/".join(_labels(coords, index)): {
            str(name): value for name, value in tree.attrs.items() if name not in own
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
    """Return the sorted union of output times; times that differ by round-off are one."""
    if not times:
        return np.empty(0)
    together = np.unique(np.concatenate(times))
    if len(together) < 2:
        return together
    new = np.diff(together, prepend=-np.inf) > 1e-9 * (together[-1] - together[0])
    return np.asarray(together[new])


def _at_all_times(runs: dict[Index, xr.Dataset], dim: str) -> dict[Index, xr.Dataset]:
    """Return the runs with the output times of all."""
    times = union_of_times([data[dim].values for data in runs.values()])
    slack = 2e-9 * np.ptp(times) if times.size else 0.0
    return {
        index: data.reindex({dim: times}, method="nearest", tolerance=slack) for index, data in runs.items()
    }


def _series(trees: Mapping[Index, xr.DataTree]) -> dict[Index, xr.Dataset]:
    """Return the series of runs with the times and the pairs of all: of many bodies each run lists the pairs
    that came near each other in it.
    """
    runs = {index: series_at_outputs(tree) for index, tree in trees.items()}
    runs = {index: data for index, data in runs.items() if "time" in data.coords}
    pairs = [data["pair"].values.tolist() for data in runs.values() if "pair" in data.coords]
    if any(labels != pairs[0] for labels in pairs):
        every = list(dict.fromkeys(label for labels in pairs for label in labels))
        runs = {k: data.reindex(pair=every) if "pair" in data.coords else data for k, data in runs.items()}
    return {
        index: data.map(lambda one: one.transpose("time", ...), keep_attrs=True)
        for index, data in _at_all_times(runs, "time").items()
    }


def series_at_outputs(tree: xr.DataTree) -> xr.Dataset:
    """Return the series of a run at the multiples of its output interval, where it recorded the ends of the
    nearest steps.

    Between two records a series is taken as linear, one of means over the time since the last record as
    constant, so that its integral stays; whole numbers are those of the nearest record. A run whose outputs
    are exact is returned as it is.
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
    if mean:
        steps = np.diff(recorded).reshape(-1, *[1] * (values.ndim - 1))
        integral = np.concatenate([np.zeros_like(values[:1]), np.cumsum(steps * values[1:], axis=0)])
        between = np.diff(_at(recorded, integral, outputs, mean=False), axis=0)
        lengths = np.diff(outputs).reshape(-1, *[1] * (values.ndim - 1))
        return np.concatenate([values[:1], between / lengths])
    after = np.clip(np.searchsorted(recorded, outputs), 1, len(recorded) - 1)
    share = (outputs - recorded[after - 1]) / (recorded[after] - recorded[after - 1])
    share = np.clip(share, 0.0, 1.0).reshape(-1, *[1] * (values.ndim - 1))
    if np.array_equal(values, np.round(values), equal_nan=True):
        share = np.round(share)
    return np.asarray((1.0 - share) * values[after - 1] + share * values[after])


def _with_fields(
    dataset: xr.Dataset, coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree]
) -> xr.Dataset:
    """Add the fields of material points, if all runs that have any have the same points."""
    kept = {index: tree["particles"] for index, tree in trees.items() if "particles" in tree.children}
    if not kept:
        return dataset
    first, points = next(iter(kept.items()))
    for index, others in kept.items():
        same = list(others.children) == list(points.children) and all(
            same_points(group.to_dataset(), points[body].to_dataset())
            for body, group in others.children.items()
        )
        if not same:
            runs = " and ".join(", ".join(_labels(coords, one)) for one in (first, index))
            why = f"{runs} have other material points; run them one by one to draw them"
            return dataset.assign_attrs(fields=f"fields are not joined: {why}")
    joined = _at_all_times({index: _points(trees[index]) for index in kept}, "particle_time")
    return dataset.assign(over_grid(coords, joined)).assign_coords(
        particle_body=joined[first]["particle_body"]
    )


def _labels(coords: Mapping[str, Sequence[Any]], index: Index) -> list[str]:
    return [str(values[i]) for values, i in zip(coords.values(), index, strict=True)]


def _points(tree: xr.DataTree) -> xr.Dataset:
    """Return the fields of all bodies, one after the other, at multiples of the output interval where steps
    end beside them.
    """
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
    """Return the costs among the attributes of a run."""

    def cost(name: str) -> float:
        return float("nan" if tree is None else tree.attrs.get(name, "nan"))

    scalars = {name: ((), cost(name), {"units": unit, "long_name": meaning}) for name, unit, meaning in COSTS}
    stages = {
        f"{clock}_stage": (
            "stage",
            [cost(f"{clock}_{stage}") for stage in STAGES],
            {"units": "s", "long_name": f"{meaning} time by stage of the step"},
        )
        for clock, meaning in (("cpu", "CPU"), ("wall", "wall"))
    }
    return xr.Dataset({**scalars, **stages}, {"stage": list(STAGES)})


def _outlines(trees: Mapping[Index, xr.DataTree]) -> dict[Index, xr.Dataset]:
    """Return first and last outlines as closed polylines, NaN between a body's loops and after the last."""
    lines: dict[Index, dict[str, AnyArray]] = {}
    for index, tree in trees.items():
        surfaces = tree["surface"].children if "surface" in tree.children else {}
        known = {str(body): _outline(node.to_dataset()) for body, node in surfaces.items()}
        lines[index] = {body: line for body, line in known.items() if line is not None}
    bodies = list(dict.fromkeys(body for of_run in lines.values() for body in of_run))
    if not bodies:
        return {}
    longest = max(line.shape[1] for of_run in lines.values() for line in of_run.values())
    meaning = "surface of the body at the first and last output; NaN parts its loops"
    outlines = {}
    for index, of_run in lines.items():
        values, times = np.full((2, len(bodies), longest, 2), np.nan), np.full(2, np.nan)
        for body, line in of_run.items():
            values[:, bodies.index(body), : line.shape[1]] = line
            times = trees[index]["series"].coords["time"].values[[0, -1]]
        dims = ("frame", "outlined_body", "outline_node", "axis")
        outlines[index] = xr.Dataset(
            {
                "outline": (dims, values, {"units": "m", "long_name": meaning}),
                "outline_time": ("frame", times, {"units": "s", "long_name": "time of the outline"}),
            },
            {"frame": ["first", "last"], "outlined_body": bodies, "axis": ["x", "y"]},
        )
    return outlines


def _outline(surface: xr.Dataset) -> AnyArray | None:
    """Return (2, outline_node, 2), the first and last frame of a surface in the order of its segments."""
    if not {"position", "next"} <= surface.keys() or surface.sizes.get("time", 0) == 0:
        return None
    ends = surface["position"].values[[0, -1]]
    parted = np.full((2, 1, ends.shape[2]), np.nan)
    return np.concatenate(
        [part for loop in loops(surface["next"].values) for part in (ends[:, loop], parted)], axis=1
    )
