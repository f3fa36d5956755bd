"""Criteria of the hard scenes: penetration, energy, momentum and stopping distances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from hard_scenes_figure import matrix

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from mpmfw.validation import CaseRun


def of_run(run: xr.DataTree) -> dict[str, float]:
    """``penetration``, the deepest [cells], and ``energy``, the ledger's residual over the energy put in [%]."""
    series = run["series"].to_dataset()
    return {"penetration": max(0.0, -least_gap(run)), "energy": 100.0 * residual(series)}


def least_gap(run: xr.DataTree) -> float:
    """Least distance of two surfaces [cells]."""
    return float(run["series"]["min_gap"].min()) / float(run.attrs["cell_size"])


def residual(series: xr.Dataset) -> float:
    """Largest residual of the ledger over the energy put in: that of the start and the largest work of gravity."""
    start = float(series["total_energy"].isel(time=0).sum())
    given = float(series["gravity_work"].max()) if "gravity_work" in series else 0.0
    return float(np.abs(series["energy_residual"]).max()) / (start + max(given, 0.0))


def momentum_made(run: xr.DataTree) -> float:
    """Largest change of the whole momentum, over the sum of what the bodies bring."""
    momentum = run["series"]["linear_momentum"]
    whole = momentum.sum("body")
    brought = float(np.abs(momentum.isel(time=0)).sum())
    return float(np.abs(whole - whole.isel(time=0)).max()) / brought


def stops(run: xr.DataTree, body: str, after: float) -> dict[str, float]:
    """Way of a body to the end of the run, by which it has stopped, against where it must stop [m]: error in %."""
    along: Any = run["series"]["centre_of_mass"].sel(body=body, axis="x").values
    return {"stops": 100.0 * (float(along[-1] - along[0]) / after - 1.0)}


def draw(runs: Sequence[CaseRun]) -> Figure:
    """The matrix of scenes and contacts."""
    gaps = {(run.place.at, run.method.contact): least_gap(run.results) for run in runs}
    return matrix(gaps, {run.place.at: run.place.within["penetration"][1] for run in runs})
