"""Functions for notebooks as methods of xarray's trees and datasets: the accessor ``.mpmfw``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import xarray as xr

from mpmfw.results import notebook

if TYPE_CHECKING:
    import pandas as pd


@xr.register_datatree_accessor("mpmfw")  # type: ignore[no-untyped-call]
@xr.register_dataset_accessor("mpmfw")  # type: ignore[no-untyped-call]
class Accessor:
    """Functions for notebooks as methods: ``tree.mpmfw.history("min_gap")`` is ``mpmfw.history(tree,
    "min_gap")``.

    It is registered once mpmfw has made or opened a result.
    """

    def __init__(self, results: xr.DataTree | xr.Dataset) -> None:
        self._results = results

    def history(self, name: str, **selection: str | None) -> xr.DataArray:
        """Return a series over time; see :func:`mpmfw.history`."""
        return notebook.history(self._results, name, **selection)

    def gap(self, pair: str | None = None) -> xr.DataArray:
        """Return the least distance of a pair; see :func:`mpmfw.gap`."""
        return notebook.gap(self._results, pair)

    def field(
        self, name: str = "von_mises", *, time: float | None = None, body: str | None = None
    ) -> xr.DataArray:
        """Return a field on the material points; see :func:`mpmfw.field`."""
        return notebook.field(self._results, name, time=time, body=body)

    def table(self) -> pd.DataFrame:
        """Return the table of a comparison; see :func:`mpmfw.table`."""
        return notebook.table(self._results)

    def pareto(self) -> pd.DataFrame:
        """Return the Pareto front of a study; see :func:`mpmfw.pareto`."""
        return notebook.pareto(self._results)
