"""Scalar fields of material points: those stored, components and sizes of vectors and tensors, and a few
more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from mpmfw.results.outputs import bodies_of, checked_name
from mpmfw.state.fields import FloatArray

_AXES = "xyz"
#: Where the name with spaces is not what a reader calls it.
_WORDS = {"von_mises": "von Mises stress"}


@dataclass(frozen=True)
class PointField:
    """One scalar for every material point.

    Parameters
    ----------
    name
        As it is asked for: ``von_mises``, ``velocity``, ``stress_xy`` …
    label
        In words, for an axis.
    unit
        SI unit as CF writes it; ``1`` if there is none.
    of
        From the material points of one body at one output to (n,) values.
    """

    name: str
    label: str
    unit: str
    of: Callable[[xr.Dataset], FloatArray]


def point_fields(tree: xr.DataTree, body: str | None = None) -> dict[str, PointField]:
    """All scalar fields that the stored material points of a run have, by name.

    Scalars are there by their own names. A vector gives its size under its name and its components as
    ``velocity_x``; a tensor its components as ``stress_xy``. Beyond these: ``volume_ratio``, det F;
    ``pressure``, −tr σ/3, in 3D; ``in_plane_pressure``, −(σ_xx + σ_yy)/2, in 2D, where the stress across the
    plane is not stored. A field that a plug-in stores under one of these names takes its place.

    Raises
    ------
    SceneError
        The run stored no material points.
    """
    points = tree[f"particles/{body or bodies_of(tree)[0]}"].to_dataset()
    found: dict[str, PointField] = {}
    for name, array in points.data_vars.items():
        if "particle" in array.dims:
            found |= _of_array(str(name), array)
    return _derived(points) | found


def point_field(tree: xr.DataTree, name: str, body: str | None = None) -> PointField:
    """The field of that name.

    Raises
    ------
    SceneError
        There is none; the message lists what is there.
    """
    fields = point_fields(tree, body)
    return fields[checked_name("field", name, list(fields))]


def _of_array(name: str, array: xr.DataArray) -> dict[str, PointField]:
    base = name.removesuffix("_difference")
    unit, words = str(array.attrs.get("units", "1")), _WORDS.get(base, base.replace("_", " "))
    words = words if base == name else f"difference of {words}"
    inner = [dim for dim in array.dims if dim not in ("time", "particle")]
    if not inner:
        return {name: PointField(name, words, unit, lambda frame: _plain(frame[name]))}
    axes = _AXES[: array.sizes[inner[0]]]
    if inner == ["axis"]:
        size = PointField(name, words, unit, lambda frame: np.linalg.norm(_plain(frame[name]), axis=1))
        parts = {
            f"{name}_{axis}": PointField(f"{name}_{axis}", f"{words}, {axis}", unit, _component(name, k))
            for k, axis in enumerate(axes)
        }
        # The length of a position vector means nothing
        return parts if name == "position" else {name: size, **parts}
    if inner == ["axis", "axis2"]:
        return {
            f"{name}_{a}{b}": PointField(f"{name}_{a}{b}", f"{words}, {a}{b}", unit, _component(name, i, j))
            for i, a in enumerate(axes)
            for j, b in enumerate(axes)
        }
    return {}


def _component(name: str, *index: int) -> Callable[[xr.Dataset], FloatArray]:
    def of(frame: xr.Dataset) -> FloatArray:
        values = _plain(frame[name])
        for k in index:
            values = values[:, k]
        return values

    return of


def _derived(points: xr.Dataset) -> dict[str, PointField]:
    found = {}
    if "deformation_gradient" in points:
        found["volume_ratio"] = PointField(
            "volume_ratio",
            "volume ratio det F",
            "1",
            lambda f: np.linalg.det(_plain(f["deformation_gradient"])),
        )
    if "stress" in points:
        dim = points["stress"].sizes["axis"]
        name = "pressure" if dim == 3 else "in_plane_pressure"
        label = "pressure" if dim == 3 else "in-plane pressure −(σxx + σyy)/2"
        unit = str(points["stress"].attrs.get("units", "Pa"))
        found[name] = PointField(
            name, label, unit, lambda f: -np.trace(_plain(f["stress"]), axis1=1, axis2=2) / dim
        )
    return found


def _plain(array: xr.DataArray) -> FloatArray:
    return np.asarray(array.values, dtype=float)
