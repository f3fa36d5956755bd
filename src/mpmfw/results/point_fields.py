"""Scalar fields of material points: stored ones, sizes and components."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import did_you_mean
from mpmfw.state.fields import FloatArray

#: Fields of surface nodes that follow from contact forces, see :mod:`mpmfw.results.fields`.
CONTACT_FIELDS = ("contact_pressure", "contact_traction")
#: Labels of fields that are not their names with spaces.
_WORDS = {"von_mises": "von Mises stress"}


class _Part(NamedTuple):
    """A scalar that follows from a stored array."""

    array: str
    label: str
    of: Callable[[FloatArray], FloatArray]  #: from the array's values (…, axis, axis2)


def point_field(points: xr.Dataset, name: str) -> xr.DataArray:
    """Return a scalar field of a body's material points, (particle,) or (time, particle).

    A vector gives its magnitude and components such as ``velocity_x``, a tensor components such as
    ``stress_xy``. Derived fields are ``volume_ratio``, det F; ``pressure``, −tr σ/3, in 3D; and
    ``in_plane_pressure``, −(σ_xx + σ_yy)/2, in 2D. A stored field of the same name takes precedence. For an
    unknown name a SceneError lists the fields.
    """
    parts = point_fields(points)
    if name not in parts:
        if name in CONTACT_FIELDS:
            why = "is on surface nodes; for single runs mpmfw.field and the command plot have it"
            raise SceneError(f"field '{name}' {why}; expected a field of material points")
        raise SceneError(f"no field '{name}'; {did_you_mean(name, {*parts, *CONTACT_FIELDS})}")
    part = parts[name]
    stored = points[part.array]
    values = part.of(stored.values.astype(float))
    unit = "1" if name == "volume_ratio" else str(stored.attrs.get("units", "1"))
    return xr.DataArray(
        values, dims=stored.dims[: values.ndim], name=name, attrs={"units": unit, "long_name": part.label}
    )


def point_fields(points: xr.Dataset) -> dict[str, _Part]:
    """Return all fields that :func:`point_field` finds, by name."""
    found = {}
    if "deformation_gradient" in points:
        found["volume_ratio"] = _Part("deformation_gradient", "volume ratio det F", np.linalg.det)
    if "stress" in points:
        dim = points["stress"].sizes["axis"]
        name, label = (
            ("pressure",) * 2 if dim == 3 else ("in_plane_pressure", "in-plane pressure −(σxx + σyy)/2")
        )
        found[name] = _Part("stress", label, lambda stress: -np.trace(stress, axis1=-2, axis2=-1) / dim)
    for array in points.data_vars:
        if "particle" in points[array].dims:
            found |= dict(_parts(str(array), points[array]))
    return found


def _parts(name: str, array: xr.DataArray) -> Iterator[tuple[str, _Part]]:
    base = name.removesuffix("_difference")
    words = _WORDS.get(base, base.replace("_", " "))
    words = words if base == name else f"difference of {words}"
    inner = [dim for dim in array.dims if dim not in ("time", "particle")]
    axes = "xyz"[: array.sizes[inner[0]]] if inner else ""
    if not inner:
        yield name, _Part(name, words, lambda values: values)
    elif inner == ["axis"]:
        if name != "position":  # whose length means nothing
            yield name, _Part(name, words, lambda values: np.linalg.norm(values, axis=-1))
        for i, a in enumerate(axes):
            yield f"{name}_{a}", _Part(name, f"{words}, {a}", _component(i))
    elif inner == ["axis", "axis2"]:
        for i, a in enumerate(axes):
            for j, b in enumerate(axes):
                part = _Part(name, f"{words}, {a}{b}", _component(i, j))
                yield f"{name}_{a}{b}", part


def _component(*index: int) -> Callable[[FloatArray], FloatArray]:
    place: tuple[Any, ...] = (..., *index)
    return lambda values: np.asarray(values[place])
