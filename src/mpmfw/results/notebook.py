"""Histories, gaps, fields, tables and Pareto fronts for notebooks, of trees and datasets however these were
made.

Each is a plain function, and a method of the accessor ``.mpmfw`` of xarray's trees and datasets.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.results.outputs import (
    Results,
    bodies_of,
    checked_name,
    frame_at,
    frame_of,
    opened,
    opened_run,
    series_of,
    times_of,
)
from mpmfw.results.point_fields import point_field

if TYPE_CHECKING:
    import pandas as pd


def history(
    results: Results,
    name: str,
    *,
    body: str | None = None,
    pair: str | None = None,
    axis: str | None = None,
) -> xr.DataArray:
    """A series over time.

    Parameters
    ----------
    results
        A run, or a comparison, whose methods are dimensions of the answer; a tree, a dataset or a file's
        name.
    name
        ``centre_of_mass``, ``min_gap`` …, see the page on results.
    body, pair, axis
        Only this one; ``axis`` also chooses the component of a rotation. What is not chosen stays a
        dimension, but for the pair of a scene that has one.

    Returns
    -------
    xarray.DataArray
        With ``units`` and ``long_name``: ``.plot()`` labels itself.

    Raises
    ------
    SceneError
        There is no such series, body, pair or axis; the message says what is there.
    """
    dataset = _series(results)
    array = dataset[checked_name("series", name, sorted(str(one) for one in dataset.data_vars))]
    for kind, label in {"body": body, "pair": pair, "axis": axis}.items():
        dim = "rotation" if kind == "axis" and "rotation" in array.dims else kind
        if label is None:
            continue
        if dim not in array.dims:
            raise SceneError(f"{kind} '{label}': has no effect, since '{name}' has no {kind}")
        array = array.sel({dim: checked_name(kind, label, [str(one) for one in array[dim].values])})
    return array.squeeze("pair") if pair is None and array.sizes.get("pair") == 1 else array


def gap(results: Results, pair: str | None = None) -> xr.DataArray:
    """Least distance between the surfaces of a pair over time [m]; negative where they penetrate.

    Parameters
    ----------
    results
        A run or a comparison.
    pair
        ``a-b``, in the scene's order; may be left out where there is one pair.

    Raises
    ------
    SceneError
        The gap was not recorded, or there is no such pair.
    """
    return history(results, "min_gap", pair=pair)


def field(
    results: Results, name: str = "von_mises", *, time: float | None = None, body: str | None = None
) -> xr.DataArray:
    """A scalar field on the material points at one output.

    Parameters
    ----------
    results
        A run.
    name
        ``von_mises``, ``velocity`` (its size), ``velocity_x``, ``stress_xy`` …, see
        :func:`mpmfw.results.point_fields.point_fields`.
    time
        [s]; the nearest output, the last one by default.
    body
        Only this one; all by default.

    Returns
    -------
    xarray.DataArray
        Over ``particle``, with the coordinates ``x``, ``y`` (and ``z``) [m], ``body`` and ``time``.

    Raises
    ------
    SceneError
        There is no such field, body or time, or the run keeps no material points.
    """
    with opened_run(results) as tree:
        return _field(tree, name, frame_at(tree, time), body)


def _field(tree: xr.DataTree, name: str, index: int, body: str | None) -> xr.DataArray:
    parts = []
    for one in bodies_of(tree, None if body is None else [body]):
        known = point_field(tree, name, one)
        frame = frame_of(tree, f"particles/{one}", index)
        position = np.asarray(frame["position"].values, dtype=float)
        coords: dict[str, Any] = {
            axis: ("particle", position[:, k], {"units": "m"})
            for k, axis in enumerate("xyz"[: position.shape[1]])
        }
        coords["body"] = ("particle", [one] * len(position))
        attributes = {"units": known.unit, "long_name": known.label}
        parts.append(
            xr.DataArray(known.of(frame), dims="particle", coords=coords, name=name, attrs=attributes)
        )
    joined = xr.concat(parts, "particle")
    return joined.assign_coords(time=times_of(tree)[index])


def table(comparison: Results) -> pd.DataFrame:
    """The table of a comparison: a row for each method, with errors, gaps and costs.

    Parameters
    ----------
    comparison
        Of ``mpmfw.compare``, or its file's name.

    Returns
    -------
    pandas.DataFrame
        Indexed by the methods; columns as in the report, errors in per cent; NaN where a run did not get
        there.

    Raises
    ------
    SceneError
        The dataset is none of a comparison.
    """
    from mpmfw.report import method_dims
    from mpmfw.report import table as rows_of

    dataset = _series(comparison)
    if "status" not in dataset or dataset.attrs.get("kind") != "compare":
        raise SceneError("these are no results of a comparison (mpmfw.compare)")
    rows = rows_of(dataset)
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = {name: ("run", [row.get(name, np.nan) for row in rows]) for name in names}
    return xr.Dataset(columns).to_dataframe().set_index([str(dim) for dim in method_dims(dataset)])


def pareto(study: Results) -> pd.DataFrame:
    """The runs of a study that no other one beats in error and in cost, the cheapest first.

    Parameters
    ----------
    study
        Of ``mpmfw.study``, or its file's name.

    Returns
    -------
    pandas.DataFrame
        Indexed by the dimensions of the study, with ``error`` (relative) and ``cpu_time`` [s].

    Raises
    ------
    SceneError
        The dataset is none of a study.
    """
    dataset = _series(study)
    if not {"error", "cpu_time", "pareto"} <= set(dataset.data_vars):
        raise SceneError("these are no results of a study (mpmfw.study)")
    rows = dataset[["error", "cpu_time", "pareto"]].to_dataframe()
    front = rows[rows["pareto"].astype(bool)]
    return front[["error", "cpu_time"]].sort_values("cpu_time")


def _series(results: Results) -> xr.Dataset:
    """Return the series of a run or a comparison; of a file not the frames."""
    with opened(results) as found:
        return series_of(found).load()
