"""Join the trees of several runs into one dataset; where a run has nothing to say stands NaN."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.results.resampling import series_at_outputs
from mpmfw.results.selection import same_points
from mpmfw.state.clock import COSTS, STAGES
from mpmfw.state.fields import AnyArray, FloatArray, IntArray

#: Root attributes of a run that say how it was computed, where ``auto`` leaves that to the shape function.
STEPPING: tuple[tuple[str, str], ...] = (
    ("scheme", "order of the step"),
    ("transfer", "between points and grid"),
)

#: Attributes that differ between the runs of a comparison and say nothing of the whole.
_OF_ONE_RUN = {"contact", "shape", "effects", "plugins", "status", "kind", "surface_nodes"}


Index = tuple[int, ...]


def join(
    coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree], *, fields: bool = True
) -> xr.Dataset:
    """Join what the runs of a grid wrote.

    Parameters
    ----------
    coords
        Values of the new dimensions, in their order.
    trees
        What runs wrote, by index into them.
    fields
        Join the fields of material points as well, where runs have any.

    Returns
    -------
    xarray.Dataset
        Scheme and transfer, as far as they are known and not varied; series, costs, costs by stage, first and
        last outlines, and fields as ``particle_<name>``, over the new dimensions. Where material points
        differ, the attribute ``fields`` says so.
    """
    points = np.ndindex(*(len(values) for values in coords.values()))
    costs = over_grid(coords, {index: _costs(trees.get(index, xr.DataTree())) for index in points})
    parts = [_stepping(coords, trees), _series(coords, trees), costs, _outlines(coords, trees)]
    named = {name: list(values) for name, values in coords.items()}
    dataset = xr.Dataset({name: array for part in parts for name, array in part.items()}, named)
    dataset = dataset.assign_attrs(_attributes(coords, trees))
    return _with_fields(dataset, coords, trees) if fields else dataset


def over_grid(
    coords: Mapping[str, Sequence[Any]], runs: Mapping[Index, xr.Dataset]
) -> dict[str, xr.DataArray]:
    """Numbers of runs, which have the same coordinates, with the dimensions of the grid before their own;
    NaN where none are.
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


def _stepping(coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree]) -> dict[str, Any]:
    """Scheme and transfer of every run, as far as they are known. Where one is varied its dimension says
    it.
    """
    found = {}
    for name, meaning in STEPPING:
        words = np.full(tuple(len(values) for values in coords.values()), "", dtype=object)
        for index, tree in trees.items():
            words[index] = str(tree.attrs.get(name, ""))
        if name not in coords and words.any():
            found[name] = xr.DataArray(words, dims=tuple(coords), attrs={"long_name": meaning})
    return found


def _attributes(coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree]) -> dict[str, Any]:
    """Keep what all runs share and the first one's scene; ``methods`` holds what differs, run by run."""
    own = {name for name, _, _ in COSTS} | {
        f"{clock}_{stage}" for clock in ("cpu", "wall", "settle_cpu") for stage in STAGES
    }
    runs = {
        index: {str(name): value for name, value in tree.attrs.items() if name not in own}
        for index, tree in trees.items()
    }
    first = next(iter(runs.values()), {})
    common = {
        name: value
        for name, value in first.items()
        if name not in _OF_ONE_RUN and all(str(run.get(name)) == str(value) for run in runs.values())
    }
    methods = {
        "/".join(map(str, _choice(coords, index))): {
            name: value
            for name, value in run.items()
            if name not in common and name not in ("scene", "kind", "status")
        }
        for index, run in runs.items()
    }
    scene = {"scene": first["scene"]} if "scene" in first else {}
    return {**common, **scene, "kind": "compare", "methods": json.dumps(methods, default=_number)}


def _number(value: Any) -> Any:
    """Return a NumPy scalar as Python's own, for JSON."""
    return value.item() if isinstance(value, np.generic) else str(value)


def _choice(coords: Mapping[str, Sequence[Any]], index: Index) -> list[Any]:
    return [values[i] for values, i in zip(coords.values(), index, strict=True)]


def union_of_times(times: Sequence[FloatArray]) -> FloatArray:
    """Sorted union of output times; times that differ by round-off are one."""
    if not times:
        return np.empty(0)
    together = np.unique(np.concatenate(times))
    if len(together) < 2:
        return together
    new = np.diff(together, prepend=-np.inf) > 1e-9 * (together[-1] - together[0])
    return np.asarray(together[new])


def _series(
    coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree]
) -> dict[str, xr.DataArray]:
    found = _of_all_pairs({index: series_at_outputs(tree) for index, tree in trees.items()})
    found = {index: data for index, data in found.items() if "time" in data.coords}
    times = union_of_times([data["time"].values for data in found.values()])
    slack = 2e-9 * np.ptp(times) if times.size else 0.0
    whole = {
        index: data.reindex(time=times, method="nearest", tolerance=slack).map(
            lambda one: one.transpose("time", ...), keep_attrs=True
        )
        for index, data in found.items()
    }
    return over_grid(coords, whole)


def _with_fields(
    dataset: xr.Dataset, coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree]
) -> xr.Dataset:
    """Add the fields of material points, if all runs that have any have the same points."""
    kept = {index: tree for index, tree in trees.items() if "particles" in tree.children}
    for index, tree in kept.items():
        first = next(iter(kept))
        if not _same_points(tree.children["particles"], kept[first].children["particles"]):
            runs = " and ".join(", ".join(map(str, _choice(coords, one))) for one in (first, index))
            text = (
                f"fields are not joined: {runs} have other material points; run them one by one to draw them"
            )
            return dataset.assign_attrs(fields=text)
    found = {index: _points(tree) for index, tree in kept.items()}
    if not found:
        return dataset
    times = union_of_times([data["particle_time"].values for data in found.values()])
    slack = 2e-9 * np.ptp(times) if times.size else 0.0
    whole = {
        index: data.reindex(particle_time=times, method="nearest", tolerance=slack)
        for index, data in found.items()
    }
    bodies = next(iter(found.values()))["particle_body"]
    return dataset.assign(over_grid(coords, whole)).assign_coords(particle_body=bodies)


def _same_points(one: xr.DataTree, other: xr.DataTree) -> bool:
    return list(one.children) == list(other.children) and all(
        same_points(group.to_dataset(), other.children[body].to_dataset())
        for body, group in one.children.items()
    )


def _points(tree: xr.DataTree) -> xr.Dataset:
    """The fields of all bodies, which follow each other, at multiples of the output interval where steps
    end beside them.
    """
    groups = {body: node.to_dataset() for body, node in tree["particles"].children.items()}
    names = dict.fromkeys(str(name) for group in groups.values() for name in group.data_vars)
    times = next(iter(groups.values()))["time"].values
    if tree.attrs.get("outputs", "exact") != "exact":
        interval = float(tree.attrs["output_interval"])
        times = np.append(interval * np.round(times[:-1] / interval), times[-1:])
    joined = {}
    for name in names:
        array = next(group[name] for group in groups.values() if name in group)
        if "particle" not in array.dims:
            continue
        axis = array.dims.index("particle")
        parts = []
        for group in groups.values():
            shape = [group.sizes.get(str(dim), array.sizes[dim]) for dim in array.dims]
            parts.append(group[name].values if name in group else np.full(shape, np.nan))
        dims = ["particle_time" if dim == "time" else dim for dim in array.dims]
        joined[f"particle_{name}"] = (dims, np.concatenate(parts, axis), array.attrs)
    labels = np.repeat(list(groups), [group.sizes["particle"] for group in groups.values()])
    inner = {dim: groups[next(iter(groups))][dim].values for dim in ("axis", "axis2") if dim in tree.coords}
    return xr.Dataset(
        joined,
        {
            "particle_time": ("particle_time", times, {"units": "s"}),
            "particle_body": ("particle", labels),
            **inner,
        },
    )


def _of_all_pairs(series: dict[Index, xr.Dataset]) -> dict[Index, xr.Dataset]:
    """The runs' series with the pairs of all: of many bodies each run lists those that came near each
    other in it.
    """
    listed = [data["pair"].values.tolist() for data in series.values() if "pair" in data.coords]
    if all(labels == listed[0] for labels in listed):
        return series
    every = list(dict.fromkeys(label for labels in listed for label in labels))
    return {
        index: data.reindex(pair=every) if "pair" in data.coords else data for index, data in series.items()
    }


def _costs(tree: xr.DataTree) -> xr.Dataset:
    """What a run took, as its attributes say it."""

    def said(name: str) -> float:
        return float(tree.attrs.get(name, np.nan))

    scalars = {name: ((), said(name), {"units": unit, "long_name": meaning}) for name, unit, meaning in COSTS}
    stages = {
        f"{clock}_stage": (
            "stage",
            [said(f"{clock}_{stage}") for stage in STAGES],
            {"units": "s", "long_name": f"{meaning} time by stage of the step"},
        )
        for clock, meaning in (("cpu", "CPU"), ("wall", "wall"))
    }
    return xr.Dataset({**scalars, **stages}, {"stage": list(STAGES)})


def _outlines(
    coords: Mapping[str, Sequence[Any]], trees: Mapping[Index, xr.DataTree]
) -> dict[str, xr.DataArray]:
    """First and last outlines as closed polylines, NaN between the loops of a body and after its last."""
    found: dict[Index, dict[str, AnyArray]] = {}
    for index, tree in trees.items():
        surfaces = tree["surface"].children if "surface" in tree.children else {}
        lines = {str(body): _outline(node.to_dataset()) for body, node in surfaces.items()}
        found[index] = {body: line for body, line in lines.items() if line is not None}
    bodies = list(dict.fromkeys(body for lines in found.values() for body in lines))
    longest = max((line.shape[1] for lines in found.values() for line in lines.values()), default=0)
    said = {
        "units": "m",
        "long_name": "surface of the body at the first and last output; NaN parts its loops",
    }
    named = {"frame": ["first", "last"], "outlined_body": bodies, "axis": ["x", "y"]}
    outlines = {}
    for index, drawn in found.items():
        values, times = np.full((2, len(bodies), longest, 2), np.nan), np.full(2, np.nan)
        for body, line in drawn.items():
            values[:, bodies.index(body), : line.shape[1]] = line
            times = trees[index]["series"].coords["time"].values[[0, -1]]
        outlines[index] = xr.Dataset(
            {
                "outline": (("frame", "outlined_body", "outline_node", "axis"), values, said),
                "outline_time": ("frame", times, {"units": "s", "long_name": "time of the outline"}),
            },
            named,
        )
    return over_grid(coords, outlines) if bodies else {}


def _outline(surface: xr.Dataset) -> AnyArray | None:
    """Return (2, outline_node, 2), the first and last frame of a surface in the order of its segments."""
    if not {"position", "next"} <= surface.keys() or surface.sizes.get("time", 0) == 0:
        return None
    ends = surface["position"].values[[0, -1]]
    parted = np.full((2, 1, ends.shape[2]), np.nan)
    return np.concatenate(
        [part for loop in loops(surface["next"].values) for part in (ends[:, loop], parted)], axis=1
    )


def loops(following: IntArray) -> list[IntArray]:
    """Split the segments of a surface into closed loops of nodes, the first node repeated at the end."""
    left = dict.fromkeys(range(len(following)))
    found = []
    while left:
        start = next(iter(left))
        loop, node = [start], int(following[start])
        left.pop(start)
        while node in left:
            left.pop(node)
            loop.append(node)
            node = int(following[node])
        found.append(np.array([*loop, start]))
    return found
