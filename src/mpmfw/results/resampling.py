"""Series of a run at the times that its scene asks for, where it recorded the ends of the nearest steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.results.reading import output_times
from mpmfw.state.fields import AnyArray, FloatArray

if TYPE_CHECKING:
    import xarray as xr


def series_at_outputs(tree: xr.DataTree) -> xr.Dataset:
    """The series of a run at the multiples of its output interval, so that runs with other steps can stand
    beside it.

    Between two records a series is taken as linear, one of means over the time since the last record as
    constant, so that its integral stays; whole numbers are those of the nearest record. A run whose outputs
    are exact is returned as it is.

    Parameters
    ----------
    tree
        Of the run.
    """
    series, times = tree["series"].to_dataset(), output_times(tree)
    if tree.attrs.get("outputs", "exact") == "exact" or times.size < 2:
        return series
    recorded: FloatArray = np.asarray(times.values, dtype=np.float64)
    interval = float(tree.attrs["output_interval"])
    asked: FloatArray = interval * np.arange(int(recorded[-1] / interval + 1e-9) + 1.0)
    if recorded[-1] - asked[-1] > 1e-9 * recorded[-1]:  # the last output is the end of the run
        asked = np.append(asked, recorded[-1])
    known = {
        name: (array.dims, _at(recorded, array.values, asked, mean=_is_mean(array)), array.attrs)
        for name, array in series.transpose("time", ...).data_vars.items()
    }
    coords = {name: coord for name, coord in series.coords.items() if name != "time"}
    return type(series)(known, {**coords, "time": ("time", asked, times.attrs)})


def _is_mean(array: xr.DataArray) -> bool:
    return str(array.attrs.get("cell_methods", "")) == "time: mean"


def _at(recorded: FloatArray, values: AnyArray, asked: FloatArray, *, mean: bool) -> AnyArray:
    """Values (recorded, …) at the times asked for, (asked, …)."""
    if mean:
        steps = np.diff(recorded).reshape(-1, *[1] * (values.ndim - 1))
        integral = np.concatenate([np.zeros_like(values[:1]), np.cumsum(steps * values[1:], axis=0)])
        between = np.diff(_at(recorded, integral, asked, mean=False), axis=0)
        lengths = np.diff(asked).reshape(-1, *[1] * (values.ndim - 1))
        return np.concatenate([values[:1], between / lengths])
    after = np.clip(np.searchsorted(recorded, asked), 1, len(recorded) - 1)
    share = (asked - recorded[after - 1]) / (recorded[after] - recorded[after - 1])
    share = np.clip(share, 0.0, 1.0).reshape(-1, *[1] * (values.ndim - 1))
    if np.array_equal(values, np.round(values), equal_nan=True):
        share = np.round(share)
    return np.asarray((1.0 - share) * values[after - 1] + share * values[after])
