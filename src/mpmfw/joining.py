"""Join the trees of several runs into one dataset; where a run has nothing to say stands NaN."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.clock import COSTS, STAGES
from mpmfw.fields import AnyArray, FloatArray, IntArray
from mpmfw.results.resampling import series_at_outputs

#: Root attributes of a run that say how it was computed, where ``auto`` leaves that to the shape function.
STEPPING: tuple[tuple[str, str], ...] = (
    ("scheme", "order of the step"),
    ("transfer", "between points and grid"),
)

#: Attributes that differ between the runs of a comparison and say nothing of the whole.
_OF_ONE_RUN = {"contact", "shape", "effects", "plugins", "status", "kind", "surface_nodes"}


def join(
    coords: Mapping[str, Sequence[Any]],
    statuses: Mapping[tuple[int, ...], str],
    trees: Mapping[tuple[int, ...], xr.DataTree],
    notes: Mapping[tuple[int, ...], Sequence[str]],
    varied: Mapping[str, str],
) -> xr.Dataset:
    """Join the runs of a grid.

    Parameters
    ----------
    coords
        Values of the new dimensions, in their order.
    statuses
        For each index into them how it went; combinations that are not there have the status "not run".
    trees, notes
        What runs wrote, and what their reader must know.
    varied
        Full keys of the dimensions that are varied keys of the scene, kept as the attribute ``varied``.

    Returns
    -------
    xarray.Dataset
        Series, costs, costs by stage, status and first and last outlines over the new dimensions.
    """
    lead, shape = tuple(coords), tuple(len(values) for values in coords.values())
    status = np.full(shape, "not run", dtype=object)
    for index, text in statuses.items():
        status[index] = text
    dataset = xr.Dataset(coords={name: list(values) for name, values in coords.items()})
    dataset["status"] = (lead, status, {"long_name": "ok, or why there is no complete result"})
    dataset = dataset.assign(_stepping(coords, trees))
    dataset = dataset.assign(_series(lead, shape, trees))
    dataset = dataset.assign(_costs(lead, shape, trees)).assign(_outlines(lead, shape, trees))
    dataset.attrs = _attributes(coords, trees)
    if varied:
        dataset.attrs["varied"] = json.dumps(dict(varied))
    by_label = {
        "/".join(map(str, _choice(coords, index))): list(words) for index, words in notes.items() if words
    }
    if by_label:
        dataset.attrs["notes"] = json.dumps(by_label)
    return dataset


def _stepping(
    coords: Mapping[str, Sequence[Any]], trees: Mapping[tuple[int, ...], xr.DataTree]
) -> dict[str, Any]:
    """Scheme and transfer of every run, as far as they are known. Where one is varied its dimension says it."""
    found = {}
    for name, meaning in STEPPING:
        words = np.full(tuple(len(values) for values in coords.values()), "", dtype=object)
        for index, tree in trees.items():
            words[index] = str(tree.attrs.get(name, ""))
        if name not in coords and words.any():
            found[name] = (tuple(coords), words, {"long_name": meaning})
    return found


def _attributes(
    coords: Mapping[str, Sequence[Any]], trees: Mapping[tuple[int, ...], xr.DataTree]
) -> dict[str, Any]:
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


def _choice(coords: Mapping[str, Sequence[Any]], index: tuple[int, ...]) -> list[Any]:
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
    lead: tuple[str, ...], shape: tuple[int, ...], trees: Mapping[tuple[int, ...], xr.DataTree]
) -> dict[str, xr.DataArray]:
    series = _of_all_pairs({index: series_at_outputs(tree) for index, tree in trees.items()})
    times = union_of_times([data["time"].values for data in series.values() if "time" in data.coords])
    joined: dict[str, xr.DataArray] = {}
    for index, data in series.items():
        if "time" not in data.coords:
            continue
        at = np.abs(times[:, None] - data["time"].values[None, :]).argmin(axis=0)
        for name, array in data.data_vars.items():
            rest = array.transpose("time", ...)
            if str(name) not in joined:
                joined[str(name)] = _empty(lead, shape, times, rest)
            joined[str(name)].values[index][at] = rest.values
    return joined


def _of_all_pairs(series: dict[tuple[int, ...], xr.Dataset]) -> dict[tuple[int, ...], xr.Dataset]:
    """The runs' series with the pairs of all: of many bodies each run lists those that came near each other in it."""
    listed = [data["pair"].values.tolist() for data in series.values() if "pair" in data.coords]
    if all(labels == listed[0] for labels in listed):
        return series
    every = list(dict.fromkeys(label for labels in listed for label in labels))
    return {
        index: data.reindex(pair=every) if "pair" in data.coords else data for index, data in series.items()
    }


def _empty(
    lead: tuple[str, ...], shape: tuple[int, ...], times: FloatArray, model: xr.DataArray
) -> xr.DataArray:
    values = np.full((*shape, len(times), *model.shape[1:]), np.nan)
    coords = {name: model.coords[name] for name in model.dims[1:] if name in model.coords}
    time = xr.DataArray(times, dims="time", attrs=dict(model.coords["time"].attrs))
    return xr.DataArray(values, dims=(*lead, *model.dims), coords={**coords, "time": time}, attrs=model.attrs)


def _costs(
    lead: tuple[str, ...], shape: tuple[int, ...], trees: Mapping[tuple[int, ...], xr.DataTree]
) -> dict[str, xr.DataArray]:
    def gathered(names: Sequence[str]) -> FloatArray:
        values = np.full((*shape, len(names)), np.nan)
        for index, tree in trees.items():
            values[index] = [float(tree.attrs.get(name, np.nan)) for name in names]
        return values

    costs = {
        name: xr.DataArray(gathered([name])[..., 0], dims=lead, attrs={"units": unit, "long_name": meaning})
        for name, unit, meaning in COSTS
    }
    for clock, meaning in (("cpu", "CPU"), ("wall", "wall")):
        costs[f"{clock}_stage"] = xr.DataArray(
            gathered([f"{clock}_{stage}" for stage in STAGES]),
            dims=(*lead, "stage"),
            coords={"stage": list(STAGES)},
            attrs={"units": "s", "long_name": f"{meaning} time by stage of the step"},
        )
    return costs


def _outlines(
    lead: tuple[str, ...], shape: tuple[int, ...], trees: Mapping[tuple[int, ...], xr.DataTree]
) -> dict[str, xr.DataArray]:
    """First and last outlines as closed polylines, NaN between the loops of a body and after its last."""
    found: dict[tuple[int, ...], dict[str, AnyArray]] = {}
    for index, tree in trees.items():
        surfaces = tree["surface"].children if "surface" in tree.children else {}
        lines = {body: _outline(node.to_dataset()) for body, node in surfaces.items()}
        found[index] = {str(body): line for body, line in lines.items() if line is not None}
    bodies = list(dict.fromkeys(body for lines in found.values() for body in lines))
    if not bodies:
        return {}
    longest = max(line.shape[1] for lines in found.values() for line in lines.values())
    values = np.full((*shape, 2, len(bodies), longest, 2), np.nan)
    times = np.full((*shape, 2), np.nan)
    for index, drawn in found.items():
        for body, line in drawn.items():
            values[index][:, bodies.index(body), : line.shape[1]] = line
            times[index] = trees[index]["series"].coords["time"].values[[0, -1]]
    frame = {"frame": ["first", "last"]}
    return {
        "outline": xr.DataArray(
            values,
            dims=(*lead, "frame", "outlined_body", "outline_node", "axis"),
            coords={**frame, "outlined_body": bodies, "axis": ["x", "y"]},
            attrs={
                "units": "m",
                "long_name": "surface of the body at the first and last output; NaN parts its loops",
            },
        ),
        "outline_time": xr.DataArray(
            times,
            dims=(*lead, "frame"),
            coords=frame,
            attrs={"units": "s", "long_name": "time of the outline"},
        ),
    }


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
