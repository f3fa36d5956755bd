"""Select from stored results: a run, an output, a body, the difference of two runs."""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Hashable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.errors import MpmfwError, SceneError
from mpmfw.plugin.discovery import did_you_mean
from mpmfw.results import open as open_results
from mpmfw.results.point_fields import point_field
from mpmfw.results.reading import DAMAGED, output_times
from mpmfw.state.fields import FloatArray

#: A run's tree or a comparison's dataset, or the name of its file.
Results = xr.DataTree | xr.Dataset | str | os.PathLike[str]


@contextmanager
def opened(results: Results) -> Iterator[xr.DataTree | xr.Dataset]:
    """Context with results; a file is closed at its end."""
    if isinstance(results, xr.DataTree | xr.Dataset):
        yield results
        return
    found = open_results(results, lazy=True)
    try:
        yield found
    except RuntimeError as error:  # of values that are read only now
        if not str(error).startswith("NetCDF"):
            raise
        raise MpmfwError(f"cannot read '{os.fspath(results)}': {DAMAGED}") from error
    finally:
        found.close()


@contextmanager
def opened_run(results: Results) -> Iterator[xr.DataTree]:
    """Context with the tree of one run."""
    with opened(results) as found:
        if not isinstance(found, xr.DataTree):
            kind = str(found.attrs.get("kind", "")) or "unknown"
            how = "; mpmfw.select takes one run of a comparison" if kind == "compare" else ""
            raise SceneError(f"{_source(found)}expected results of one run, not of kind '{kind}'{how}")
        yield found


def _source(results: xr.DataTree | xr.Dataset) -> str:
    """Return the name of the file with a colon, or nothing."""
    return f"{results.encoding['source']}: " if "source" in results.encoding else ""


def points_of(dataset: xr.Dataset, dims: Iterable[Hashable]) -> Iterator[tuple[dict[str, Any], xr.Dataset]]:
    """Yield labels and data of every point along some dimensions."""
    names = [str(dim) for dim in dims]
    for labels in itertools.product(*(dataset[name].values.tolist() for name in names)):
        point = dict(zip(names, labels, strict=True))
        yield point, dataset.sel(point)


def series_of(results: Results) -> xr.Dataset:
    """Return the series of a run, or the dataset of a comparison."""
    with opened(results) as found:
        if isinstance(found, xr.Dataset):
            return found.load()
        return found["series"].to_dataset().load() if "series" in found.children else xr.Dataset()


def checked_name(kind: str, name: str, valid: Sequence[str]) -> str:
    """Return the name if it is among the valid ones."""
    if name not in valid:
        raise SceneError(f"no {kind} '{name}'; {did_you_mean(name, valid) if valid else 'there is none'}")
    return name


def bodies_of(tree: xr.DataTree, selection: str | Sequence[str] | None = None) -> list[str]:
    """Return the bodies whose points are stored, in the scene's order."""
    groups = tree["particles"].children if "particles" in tree.children else {}
    order = tree.coords["body"].values.tolist() if "body" in tree.coords else list(groups)
    present = [str(name) for name in order if name in groups and groups[name].data_vars]
    if not present:
        why = "the run stored no material points; run it with output.particles = true"
        raise SceneError(f"{_source(tree)}{tree.attrs.get('fields', why)}")
    if selection is None:
        return present
    names = [selection] if isinstance(selection, str) else list(selection)
    if not names:
        raise SceneError(f"bodies: none is named; expected some of {', '.join(present)}, or None for all")
    for name in names:
        checked_name("body", name, present)
    return [name for name in present if name in names]


def rigid_bodies_of(tree: xr.DataTree, selection: Sequence[str] | None = None) -> list[str]:
    """Return bodies with a surface and no material points; none if a ``selection`` names others."""
    if selection is not None:
        return []
    surfaces, points = (tree[n].children if n in tree.children else {} for n in ("surface", "particles"))
    return [str(body) for body in surfaces if body not in points]


def times_of(tree: xr.DataTree) -> FloatArray:
    """Return the times of outputs with points, else of all [s]."""
    points = tree["particles"].children.values() if "particles" in tree.children else ()
    group = next((points for points in points if "time" in points.coords), None)
    times = output_times(tree) if group is None else group.coords["time"]
    return np.asarray(times.values, dtype=float)


def frame_at(tree: xr.DataTree, time: float | None = None) -> int:
    """Return the output with points nearest to ``time`` [s], by default the last."""
    times = times_of(tree)
    if len(times) == 0:
        raise SceneError("the run has no output")
    if time is None:
        return len(times) - 1
    slack = 0.5 * float(np.median(np.diff(times))) if len(times) > 1 else 0.0
    if not times[0] - slack <= time <= times[-1] + slack:
        raise SceneError(f"no output at {time:g} s; expected a time from {times[0]:g} to {times[-1]:g} s")
    return int(np.argmin(np.abs(times - time)))


def frame_of(tree: xr.DataTree, place: str, index: int) -> xr.Dataset:
    """Read a group, such as ``particles/disc``, at an output with points."""
    group, times = tree[place].to_dataset(), times_of(tree)
    if group.sizes.get("time", len(times)) != len(times):  # a surface has more outputs
        index = int(np.argmin(np.abs(group["time"].values - times[index])))
    return group.isel(time=index, missing_dims="ignore").load()


def chosen_frames(tree: xr.DataTree, every: int) -> list[int]:
    """Return each ``every``-th output with points, and the last one."""
    if isinstance(every, float | str | None) or every < 1:
        raise SceneError(f"every {every!r}: expected a whole number of 1 or more")
    return [*range(0, frame_at(tree), every), frame_at(tree)]


def select(comparison: Results, **choice: Any) -> xr.DataTree:
    """Return one run of a comparison as a tree: ``series``, and ``particles/<body>`` if it keeps fields.

    ``choice`` names a label for each dimension that has several, such as ``contact="penalty"``. A SceneError
    lists the labels if one is missing or unknown.
    """
    with opened(comparison) as dataset:
        if not isinstance(dataset, xr.Dataset) or "status" not in dataset:
            raise SceneError("these are not results of a comparison (mpmfw.compare)")
        index = {}
        for dim in map(str, dataset["status"].dims):
            labels = [str(label) for label in dataset[dim].values.tolist()]
            label = choice.pop(dim, labels[0] if len(labels) == 1 else None)
            if label is None:
                raise SceneError(f"{dim}: expected one of {', '.join(labels)}")
            index[dim] = labels.index(checked_name(dim, str(label), labels))
        for dim in choice:
            raise SceneError(f"{dim}: no dimension of the comparison; expected some of {', '.join(index)}")
        return _tree(dataset.isel(index).load())


def _tree(run: xr.Dataset) -> xr.DataTree:
    labels = {str(dim): run[dim].item() for dim in run["status"].coords if run[dim].ndim == 0}
    own = json.loads(run.attrs.get("methods", "{}")).get("/".join(map(str, labels.values())), {})
    attributes = {**run.attrs, **own, **labels, "kind": "run", "status": str(run["status"].item())}
    run = run.drop_vars(list(labels))
    root = xr.Dataset(
        coords={dim: run[dim] for dim in ("axis", "body", "pair") if dim in run}, attrs=attributes
    )
    series = run[[name for name in run.data_vars if "time" in run[name].dims]]
    groups = {"/": root, "/series": series.dropna("time", how="all")}
    points = [name for name in run.data_vars if "particle" in run[name].dims]
    if points:
        frames = run[points].rename({name: str(name).removeprefix("particle_") for name in points})
        frames = frames.rename(particle_time="time").dropna("time", how="all")
        for body in dict.fromkeys(run["particle_body"].values.tolist() if frames.sizes["time"] else ()):
            one = frames.isel(particle=run["particle_body"].values == body).drop_vars("particle_body")
            known = [name for name, array in one.data_vars.items() if array.notnull().any()]
            groups[f"/particles/{body}"] = one[known]
    return xr.DataTree.from_dict(groups)


def runs_of(comparison: xr.Dataset, against: str | None = None, name: str = "") -> dict[str, xr.DataTree]:
    """Return the runs of a comparison that keep points, or their differences ``against`` one contact."""
    if "particle_position" not in comparison:
        why = "the comparison keeps no fields; run it with --set output.particles=true"
        raise SceneError(str(comparison.attrs.get("fields", why)))
    if against is not None:
        checked_name("contact", against, [str(one) for one in comparison["contact"].values])
    runs = {}
    for choice, _ in points_of(comparison, comparison["status"].dims):
        run, label = select(comparison, **choice), ", ".join(map(str, choice.values()))
        if "particles" not in run.children:
            continue
        if against is None:
            runs[label] = run
        elif str(choice["contact"]) != against:
            reference = select(comparison, **{**choice, "contact": against})
            if "particles" in reference.children:
                runs[f"{label} less {against}"] = difference(run, reference, name)
    if not runs:
        which = "no two runs of the comparison keep" if against else "no run of the comparison keeps"
        raise SceneError(f"{which} fields")
    return runs


def difference(run: xr.DataTree, reference: xr.DataTree, name: str = "von_mises") -> xr.DataTree:
    """Return a run with the field ``NAME_difference`` against the ``reference``.

    Raises a SceneError if there is no such field, or the material points or their times differ.
    """
    times, others = times_of(run), times_of(reference)
    if len(times) != len(others) or not np.allclose(times, others):
        raise SceneError("fields cannot be compared: the runs recorded material points at different times")
    tree, known = run.copy(), bodies_of(reference)
    for body in bodies_of(run):
        points = run[f"particles/{body}"].to_dataset()
        own = point_field(points, name)
        theirs = reference[f"particles/{body}"].to_dataset() if body in known else None
        if theirs is None or not same_points(points, theirs):
            raise SceneError(f"fields cannot be compared: the material points of '{body}' differ")
        attributes = {**own.attrs, "long_name": f"difference of {own.attrs['long_name']}"}
        change = own.copy(data=own.values - point_field(theirs, name).values).assign_attrs(attributes)
        tree[f"particles/{body}"] = xr.DataTree(points.assign({f"{name}_difference": change}))
    return tree


def same_points(one: xr.Dataset, other: xr.Dataset) -> bool:
    """Return True if two runs have a body's points in common."""
    if one.sizes["particle"] != other.sizes["particle"]:
        return False
    begin, end = one["position"][0].values, other["position"][0].values
    size = float(one["volume"][0].max()) ** (1.0 / begin.shape[1])
    same = np.allclose(one["mass"].values, other["mass"].values, rtol=1e-6, equal_nan=True)
    return bool(same and (np.abs(begin - end) < 0.5 * size).all())
