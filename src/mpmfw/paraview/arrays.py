"""Stored fields as arrays that ParaView understands: vectors of 3, tensors of 9 components."""

from __future__ import annotations

import numpy as np
import xarray as xr

from mpmfw.state.fields import AnyArray, FloatArray

#: Out-of-plane component of tensors in 2D, plane strain, where it is known; it is NaN for the others.
_ACROSS = {"deformation_gradient": 1.0, "velocity_gradient": 0.0, "affine": 0.0}


def vectors(values: FloatArray) -> FloatArray:
    """(n, dim) as (n, 3), zero beyond the plane."""
    padded: FloatArray = np.zeros((len(values), 3))
    padded[:, : values.shape[1]] = values
    return padded


def tensors(name: str, values: FloatArray) -> FloatArray:
    """(n, dim, dim) as (n, 9), row by row: XX, XY, XZ, YX … as ParaView names them.

    In 2D the shear across the plane is zero. The zz component of the stress is not stored: it is NaN rather than
    a number that a filter would take for it.
    """
    dim = values.shape[1]
    if dim == 3:
        return values.reshape(-1, 9)
    padded: FloatArray = np.zeros((len(values), 3, 3))
    padded[:, :dim, :dim] = values
    padded[:, 2, 2] = _ACROSS.get(name, np.nan)
    return padded.reshape(-1, 9)


def arrays_of(frame: xr.Dataset, dim: str) -> tuple[dict[str, AnyArray], list[str]]:
    """All fields of one output over ``particle`` or ``surface_node``, and the names of those of another form.

    Parameters
    ----------
    frame
        One group at one output.
    dim
        The dimension that counts points.
    """
    found: dict[str, AnyArray] = {}
    other = []
    for name, array in frame.data_vars.items():
        values = array.values
        match array.dims:
            case (first,) if first == dim:
                found[str(name)] = values
            case (first, "axis") if first == dim:
                found[str(name)] = vectors(values)
            case (first, "axis", "axis2") if first == dim:
                found[str(name)] = tensors(str(name), values)
            case _:
                other.append(str(name))
    return found, other


def stacked(parts: list[dict[str, AnyArray]], counts: list[int]) -> dict[str, AnyArray]:
    """Join the arrays of several bodies; a field that a body does not have is NaN there."""
    names = dict.fromkeys(name for part in parts for name in part)
    models = {name: next(part[name] for part in parts if name in part) for name in names}
    return {
        name: np.concatenate(
            [
                part[name] if name in part else np.full((count, *model.shape[1:]), np.nan)
                for part, count in zip(parts, counts, strict=True)
            ]
        )
        for name, model in models.items()
    }
