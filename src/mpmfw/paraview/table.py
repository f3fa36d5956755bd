"""The series of a run as a table, one row an output."""

from __future__ import annotations

import csv
import io
import itertools
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from mpmfw.results.replacing import replace_bytes


def write_series(path: Path, series: xr.Dataset, frames: Sequence[int]) -> None:
    """Write series as comma-separated values, in full precision.

    Parameters
    ----------
    path
        File to write.
    series
        Over ``time``.
    frames
        Outputs to write.

    Notes
    -----
    A column is called ``centre_of_mass cylinder x [m]``: name, labels, unit.
    """
    columns = {"time [s]": np.asarray(series["time"].values[list(frames)])}
    for name, array in series.data_vars.items():
        if "time" in array.dims:
            columns |= _columns(str(name), array.isel(time=list(frames)).transpose("time", ...))
    text = io.StringIO(newline="")
    table = csv.writer(text)
    table.writerow(columns)
    table.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
    replace_bytes(text.getvalue().encode(), path)


def _columns(name: str, array: xr.DataArray) -> dict[str, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]:
    dims, unit = array.dims[1:], array.attrs.get("units", "1")
    labels = [array[dim].values.tolist() for dim in dims]
    found = {}
    for choice in itertools.product(*labels):
        head = " ".join((name, *map(str, choice)))
        values = array.sel(dict(zip(dims, choice, strict=True)), drop=True).values
        found[f"{head} [{unit}]"] = np.asarray(values, dtype=float)
    return found
