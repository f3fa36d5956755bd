"""Problems, runs and resolution of a study for its figures."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import xarray as xr

from mpmfw.results.selection import points_of

#: Dimensions that are lengths [m].
_LENGTHS = ("cell_size", "particle_size", "segment")
#: Dimensions that are a resolution, the more usual first.
_RESOLUTIONS = ("cell_size", "particle_size", "particles_per_cell", "size", "segment", "cfl", "safety")


def with_methods(dataset: xr.Dataset) -> xr.Dataset:
    """Return the study with dimensions of contact and shape."""
    for name in ("contact", "shape"):
        if name not in dataset.dims:
            label = dataset[name].item() if name in dataset.coords else "the scene's"
            dataset = dataset.drop_vars(name, errors="ignore").expand_dims({name: [label]})
    return dataset


def problems_of(dataset: xr.Dataset) -> Iterator[tuple[str, xr.Dataset]]:
    """Yield the parts of a study that can be compared, by title."""
    for labels, problem in points_of(dataset, json.loads(dataset.attrs["problem_dims"])):
        yield ", ".join(str(v) if dim == "scene" else f"{dim} {v}" for dim, v in labels.items()), problem


def runs_of(dataset: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield every run with its labels."""
    for labels, run in points_of(dataset, dataset["error"].dims):
        yield {**labels, "dims": list(labels), "run": run}


def resolution_of(dataset: xr.Dataset) -> str | None:
    """Return the dimension that the size of markers shows, if any."""
    problem_dims = json.loads(dataset.attrs["problem_dims"])
    dims = [
        str(dim)
        for dim in dataset["error"].dims
        if dim not in ("contact", "shape", *problem_dims) and dataset.sizes[dim] > 1
    ]
    usual = [dim for dim in _RESOLUTIONS if dim in dims]
    return next(iter(usual + dims), None)


def order_of(dataset: xr.Dataset, resolution: str) -> list[Any]:
    """Return the labels of the resolution, the coarsest first."""
    labels = dataset[resolution].values.tolist()
    if all(isinstance(label, int | float) for label in labels):
        return sorted(labels, reverse=resolution != "particles_per_cell")
    return list(labels)


def label_of(resolution: str, label: Any) -> str:
    """Return a label such as ``cell size 0.2 m``."""
    unit = " m" if resolution in _LENGTHS and not isinstance(label, str) else ""
    return f"{resolution.replace('_', ' ')} {label}{unit}"
