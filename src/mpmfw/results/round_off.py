"""Values below the round-off of a scene's scale, which figures and tables show as zero."""

from __future__ import annotations

import numpy as np
import xarray as xr

from mpmfw.state.fields import AnyArray

#: Share of a scene's scale below which a change is the rounding of a run of many steps.
ROUND_OFF = 1e-10


def without_round_off(series: xr.Dataset) -> xr.Dataset:
    """Return the series over time with values below round-off set to zero.

    The scale of a series is the largest magnitude of its unit: at least L/T of velocities, with the largest
    coordinate L and the time T, and one turn over T of spins. Of positions the displacement counts.
    """
    if "time" not in series.dims or series.sizes["time"] < 2:
        return series
    known = {
        str(name): one
        for name, one in series.data_vars.items()
        if "time" in one.dims and one.dtype.kind == "f"
    }
    scales: dict[str, float] = {}
    for array in known.values():
        unit = str(array.attrs.get("units", "1"))
        scales[unit] = max(scales.get(unit, 0.0), _largest(array.values))
    time = float(series["time"].values[-1] - series["time"].values[0])
    length = _largest(known["centre_of_mass"].values) if "centre_of_mass" in known else 0.0
    for name, scale in (("mean_velocity", length / time), ("angular_velocity", 2.0 * np.pi / time)):
        if name in known:
            unit = str(known[name].attrs.get("units", "1"))
            scales[unit] = max(scales[unit], scale)
    clean = {}
    for name, array in known.items():
        floor = ROUND_OFF * scales[str(array.attrs.get("units", "1"))]
        start = array.isel(time=0) if name == "centre_of_mass" else 0.0
        change = array - start
        shown = start + change.where(~(np.abs(change) <= floor), 0.0)
        clean[name] = shown.transpose(*array.dims).assign_attrs(array.attrs)
    return series.assign(clean)


def _largest(values: AnyArray) -> float:
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
