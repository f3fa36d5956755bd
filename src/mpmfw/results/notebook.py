"""Histories, gaps, fields, tables and Pareto fronts for notebooks.

Each is a function, and a method of the accessor ``.mpmfw`` of xarray.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Concatenate, ParamSpec, TypeVar

import xarray as xr

from mpmfw.errors import SceneError
from mpmfw.results.fields import field
from mpmfw.results.selection import Results, checked_name, series_of

if TYPE_CHECKING:
    import pandas as pd

P = ParamSpec("P")
T = TypeVar("T")


def history(
    results: Results,
    name: str,
    *,
    body: str | None = None,
    pair: str | None = None,
    axis: str | None = None,
) -> xr.DataArray:
    """Return a series over time.

    Parameters
    ----------
    results
        A run or a comparison, whose methods are dimensions of the result: a tree, a dataset or a file.
    name
        ``centre_of_mass``, ``min_gap`` …, see the page on results.
    body, pair, axis
        Labels to select; ``axis`` also selects the component of a rotation. Other dimensions stay, except
        the pair if the scene has only one.

    Raises
    ------
    SceneError
        There is no such series, body, pair or axis.
    """
    dataset = series_of(results)
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
    """Return the least distance between the surfaces of a ``pair`` ``a-b`` over time [m].

    It is negative where they penetrate. A scene with one pair needs no name. Raises a SceneError if the gap
    was not recorded, or there is no such pair.
    """
    return history(results, "min_gap", pair=pair)


def table(comparison: Results) -> pd.DataFrame:
    """Return the table of a comparison: a row for each method, with errors [%], gaps and costs.

    Its index are the methods; values are NaN if a run ended early. Raises a SceneError for other results.
    """
    import pandas as pd

    from mpmfw.report import method_dims
    from mpmfw.report import table as rows_of

    dataset = series_of(comparison)
    if "status" not in dataset or dataset.attrs.get("kind") != "compare":
        raise SceneError("these are not results of a comparison (mpmfw.compare)")
    return pd.DataFrame(rows_of(dataset)).set_index([str(dim) for dim in method_dims(dataset)])


def pareto(study: Results) -> pd.DataFrame:
    """Return the Pareto-optimal runs of a study in error and cost, cheapest first.

    Its index are the dimensions of the study; columns are ``error`` (relative) and ``cpu_time`` [s]. Raises a
    SceneError for other results.
    """
    dataset = series_of(study)
    if not {"error", "cpu_time", "pareto"} <= set(dataset.data_vars):
        raise SceneError("these are not results of a study (mpmfw.study)")
    rows = dataset[["error", "cpu_time", "pareto"]].to_dataframe()
    front = rows[rows["pareto"].astype(bool)]
    return front[["error", "cpu_time"]].sort_values("cpu_time")


def _method(function: Callable[Concatenate[Results, P], T]) -> Callable[Concatenate[Accessor, P], T]:
    @functools.wraps(function)
    def method(accessor: Accessor, /, *args: P.args, **kwargs: P.kwargs) -> T:
        return function(accessor.results, *args, **kwargs)

    return method


@xr.register_datatree_accessor("mpmfw")  # type: ignore[no-untyped-call]
@xr.register_dataset_accessor("mpmfw")  # type: ignore[no-untyped-call]
class Accessor:
    """Methods for notebooks, such as ``tree.mpmfw.history("min_gap")``."""

    def __init__(self, results: xr.DataTree | xr.Dataset) -> None:
        self.results = results

    history = _method(history)
    gap = _method(gap)
    field = _method(field)
    table = _method(table)
    pareto = _method(pareto)
