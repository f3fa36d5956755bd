"""One run of a comparison as a tree of its own, and the difference of a field between two runs."""

from __future__ import annotations

import itertools
import json
from typing import Any

import numpy as np
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.results.outputs import Results, bodies_of, checked_name, frame_of, opened, series_of, times_of
from mpmfw.results.point_fields import point_field


def select(comparison: Results, **choice: Any) -> xr.DataTree:
    """Return one run of a comparison as a tree as :func:`mpmfw.run` returns it.

    Parameters
    ----------
    comparison
        Of :func:`mpmfw.compare`, or the name of its file.
    choice
        A label of each dimension, such as ``contact="penalty"``; one that has a single label may be left out.

    Returns
    -------
    The group ``series``, and ``particles/<body>`` if the comparison keeps fields.

    Raises
    ------
    SceneError
        There is no such dimension or label, or a dimension is left open.
    """
    with opened(comparison) as found:
        dataset = series_of(found)
        if "status" not in dataset:
            raise SceneError("these are no results of a comparison (mpmfw.compare)")
        index = {dim: _index(dataset, dim, choice.pop(dim, None)) for dim in map(str, dataset["status"].dims)}
        for dim in choice:
            raise SceneError(f"{dim}: no dimension of the comparison; expected some of {', '.join(index)}")
        return _tree(dataset.isel(index).load())


def _index(dataset: xr.Dataset, dim: str, label: Any) -> int:
    labels = dataset[dim].values.tolist()
    if label is None:
        if len(labels) == 1:
            return 0
        raise SceneError(f"{dim}: expected one of {', '.join(map(str, labels))}")
    return [str(one) for one in labels].index(checked_name(dim, str(label), [str(one) for one in labels]))


def _tree(run: xr.Dataset) -> xr.DataTree:
    labels = {str(dim): run[dim].item() for dim in run["status"].coords if run[dim].ndim == 0}
    own = json.loads(run.attrs.get("methods", "{}")).get("/".join(map(str, labels.values())), {})
    attributes = {**run.attrs, **own, **labels, "kind": "run", "status": str(run["status"].item())}
    run = run.drop_vars(list(labels))
    points = [name for name in run.data_vars if "particle" in run[name].dims]
    series = run[[name for name in run.data_vars if "time" in run[name].dims]]
    root = xr.Dataset(
        coords={dim: run[dim] for dim in ("axis", "body", "pair") if dim in run}, attrs=attributes
    )
    groups = {"/": root, "/series": series.dropna("time", how="all")}
    if points:
        frames = run[points].rename({name: str(name).removeprefix("particle_") for name in points})
        frames = frames.rename(particle_time="time").dropna("time", how="all")
        for body in dict.fromkeys(run["particle_body"].values.tolist() if frames.sizes["time"] else ()):
            one = frames.isel(particle=run["particle_body"].values == body).drop_vars("particle_body")
            known = [name for name, array in one.data_vars.items() if array.notnull().any()]
            groups[f"/particles/{body}"] = one[known]
    return xr.DataTree.from_dict(groups)


def runs_of(
    comparison: xr.Dataset, against: str | None = None, name: str = "", *, contact: str | None = None
) -> dict[str, xr.DataTree]:
    """Return the runs of a comparison that keep material points, by their labels.

    Parameters
    ----------
    comparison
        Of :func:`mpmfw.compare`.
    against, name
        A contact and a field: every other run then has the field ``NAME_difference`` against the run with
        that contact and its own other choices.
    contact
        Only the runs with this contact.

    Raises
    ------
    SceneError
        There is no such contact, or no fields were kept or joined.
    """
    if "particle_position" not in comparison:
        why = "the comparison keeps no fields; run it with --set output.particles=true"
        raise SceneError(str(comparison.attrs.get("fields", why)))
    dims = [str(dim) for dim in comparison["status"].dims]
    contacts = [str(one) for one in comparison["contact"].values]
    for chosen in (against, contact):
        if chosen is not None:
            checked_name("contact", chosen, contacts)
    if contact is not None:
        comparison = comparison.isel(contact=[contacts.index(contact)])
    runs = {}
    for labels in itertools.product(*(comparison[dim].values.tolist() for dim in dims)):
        choice = dict(zip(dims, labels, strict=True))
        run = select(comparison, **choice)
        reference = None if against is None else select(comparison, **{**choice, "contact": against})
        if "particles" not in run.children or str(choice["contact"]) == against:
            continue
        if reference is not None and "particles" in reference.children:
            run = difference(run, reference, name)
        elif reference is not None:
            continue
        label = ", ".join(map(str, labels))
        runs[label if against is None else f"{label} less {against}"] = run
    if not runs:
        raise SceneError(
            "no two runs of the comparison keep fields"
            if against
            else "no run of the comparison keeps fields"
        )
    return runs


def difference(run: xr.DataTree, reference: xr.DataTree, name: str = "von_mises") -> xr.DataTree:
    """Return a run whose material points have a further field, ``NAME_difference``: its own values less those
    of the reference.

    Parameters
    ----------
    run, reference
        Two runs, of :func:`select`, :func:`mpmfw.run` or :func:`mpmfw.open`, with the same material points
        and outputs.
    name
        Of a scalar field, see :func:`mpmfw.results.point_fields.point_fields`.

    Raises
    ------
    SceneError
        There is no such field, or the material points or the times of their outputs differ.
    """
    groups = {f"particles/{body}": run[f"particles/{body}"].to_dataset() for body in bodies_of(run)}
    times = times_of(run)
    if len(times) != len(times_of(reference)) or not np.allclose(times, times_of(reference)):
        raise SceneError("fields cannot be compared: the runs recorded their material points at other times")
    for place, group in groups.items():
        body = place.removeprefix("particles/")
        own = point_field(run, name, body)
        if body not in bodies_of(reference) or not same_points(group, reference[place].to_dataset()):
            raise SceneError(f"fields cannot be compared: the material points of '{body}' differ")
        values = [
            own.of(frame_of(run, place, k))
            - point_field(reference, name, body).of(frame_of(reference, place, k))
            for k in range(len(times))
        ]
        attributes = {"units": own.unit, "long_name": f"difference of {own.label}"}
        groups[place] = group.assign(
            {f"{name}_difference": (("time", "particle"), np.array(values), attributes)}
        )
    tree = run.copy()
    for place, group in groups.items():
        tree[place] = xr.DataTree(group)
    return tree


def same_points(one: xr.Dataset, other: xr.Dataset) -> bool:
    """Return whether a body has the same material points in two runs: their masses, and their places but
    for settling.
    """
    if one.sizes["particle"] != other.sizes["particle"]:
        return False
    begin, size = one["position"][0].values, np.sqrt(one["volume"][0].values.max())
    if begin.shape[1] == 3:
        size = float(one["volume"][0].max()) ** (1.0 / 3.0)
    same = np.allclose(one["mass"].values, other["mass"].values, rtol=1e-6, equal_nan=True)
    return bool(same and (np.abs(begin - other["position"][0].values) < 0.5 * size).all())
