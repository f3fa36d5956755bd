"""The colliding rings of [H17], section 4.2: what the cases about them measure of a run.

[H17] is Hamad, Giridharan & Moormann (2017), Procedia Engineering 175, 116-123. The reference are the finite
elements of ``mpmfw/reference``; its README says where the tolerances come from."""

import math

import numpy as np
import xarray as xr
from scipy.spatial import cKDTree

from mpmfw.report.table import gap_measures, rings_measures
from mpmfw.results.analysis import contact_phases
from mpmfw.results.references import RingsReference, rings_table
from mpmfw.state.fields import FloatArray

REFERENCE = RingsReference("left", "right")


def series_of(tree: xr.DataTree) -> xr.Dataset:
    """Series of a run; where the method reports no contact force, the rate of the left ring's momentum is it.

    The two are the same where both are known: nothing else acts on a ring.
    """
    series = tree["series"].to_dataset()
    if "contact_force" in series:
        return series
    momentum = series["linear_momentum"].sel(body="left")
    rate = momentum.diff("time", label="upper") / momentum["time"].diff("time", label="upper")
    force = rate.reindex(time=series["time"], fill_value=0.0).drop_vars("body")
    return series.assign(
        contact_force=force.expand_dims(pair=["left-right"]).transpose("time", "pair", "axis")
    )


def force_of(series: xr.Dataset) -> tuple[FloatArray, FloatArray]:
    """Times [s] and x-force on the right ring [N/m], the mean over each output interval."""
    return series["time"].values, -series["contact_force"].isel(pair=0).sel(axis="x").values


def reference_impulse(time: FloatArray) -> FloatArray:
    """Impulse of the fine finite elements at times [s]: [N s/m]."""
    table = rings_table("force")
    return np.asarray(np.interp(time, table["time"], table["fine_impulse_Ns_per_m"]))


def drift_of(series: xr.Dataset) -> float:
    """Largest change of linear momentum over its largest component at the start."""
    momentum = series["linear_momentum"]
    drift = np.abs((momentum - momentum.isel(time=0)).sum("body")).max()
    return float(drift / np.abs(momentum.isel(time=0)).max())


def measures_of(tree: xr.DataTree) -> dict[str, float]:
    """Return what is judged: :func:`mpmfw.report.table.rings_measures` and what it leaves out.

    Times are in ms, errors in %, lengths in cells, velocities in m/s.
    """
    series = series_of(tree)
    phases = contact_phases(*force_of(series))
    return {
        **rings_measures(series, REFERENCE),
        **gap_measures(series["min_gap"].isel(pair=0).values / tree.attrs["cell_size"]),
        "gap_start": 1e3 * phases.gap_start,
        "gap_end": 1e3 * phases.gap_end,
        "momentum": drift_of(series),
        "mirror": mirror_error(tree),
    }


def mirror_error(tree: xr.DataTree) -> float:
    """Largest distance of a surface node from the mirror image of its partner [h]; NaN without surfaces."""
    if "surface" not in tree.children:
        return math.nan
    left = tree["surface/left"].to_dataset()["position"].values
    right = tree["surface/right"].to_dataset()["position"].values * np.array([-1.0, 1.0])
    apart, partner = cKDTree(left[0]).query(right[0])
    if apart.max() > 1e-9:
        return math.nan  # the two surfaces are no images of each other at the start
    return float(np.linalg.norm(left[:, partner] - right, axis=2).max() / tree.attrs["cell_size"])
