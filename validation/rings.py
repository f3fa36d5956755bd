"""The colliding rings of [H17], section 4.2: what the cases about them measure of a run.

[H17] is Hamad, Giridharan & Moormann (2017), Procedia Engineering 175, 116-123. The reference are the finite
elements of ``mpmfw/reference``; its README says where the tolerances come from."""

import math

import numpy as np
import xarray as xr
from scipy.spatial import cKDTree

from mpmfw.report.table import gap_measures, rings_measures
from mpmfw.results.analysis import averaged, contact_phases, impulse, relative_l2
from mpmfw.results.references import RingsReference, rings_table
from mpmfw.state.fields import FloatArray

REFERENCE = RingsReference("left", "right")
#: Share of the total impulse by which it may be away from its plateau between the two contacts.
NEAR = 0.005


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


def plateau(time: FloatArray, impulses: FloatArray) -> tuple[float, float]:
    """Start and end [ms] of the interval round 1.6 ms in which the impulse changes by no more than NEAR.

    A last touch of one surface node moves the end of the first contact by 0.1 ms, but carries no impulse.
    """
    middle = int(np.searchsorted(time, 1.6e-3))
    if middle >= len(time) or not np.isfinite(impulses).all():
        return math.nan, math.nan
    away = np.flatnonzero(np.abs(impulses - impulses[middle]) > NEAR * abs(impulses[-1]))
    before, after = away[away < middle], away[away > middle]
    if len(before) == 0 or len(after) == 0:
        return math.nan, math.nan
    return 1e3 * float(time[before[-1] + 1]), 1e3 * float(time[after[0] - 1])


def measures_of(tree: xr.DataTree) -> dict[str, float]:
    """Everything that is judged: :func:`mpmfw.report.table.rings_measures` and what it leaves out.

    Times are in ms, errors in %, lengths in cells, velocities in m/s.
    """
    series = series_of(tree)
    time, force = force_of(series)
    phases = contact_phases(time, force)
    start, end = plateau(time, impulse(time, force))
    exact = averaged(time, reference_impulse(time), 50e-6)
    momentum = series["linear_momentum"]
    drift = np.abs((momentum - momentum.isel(time=0)).sum("body")).max()
    velocity = series["mean_velocity"].sel(axis="x").isel(time=-1)
    lost = series["transfer_dissipation"].values[-1] if "transfer_dissipation" in series else math.nan
    return {
        **rings_measures(series, REFERENCE),
        **gap_measures(series["min_gap"].isel(pair=0).values / tree.attrs["cell_size"]),
        "force_error_50us": relative_l2(time, averaged(time, impulse(time, force), 50e-6), exact),
        "gap_start": 1e3 * phases.gap_start,
        "gap_end": 1e3 * phases.gap_end,
        "plateau_start": start,
        "plateau_end": end,
        "momentum": float(drift / np.abs(momentum.isel(time=0)).max()),
        "transfer": float(lost) / float(series["kinetic_energy"].isel(time=0).sum()),
        "mirror": mirror_error(tree),
        "rebound": 0.5 * float(velocity.sel(body="right") - velocity.sel(body="left")),
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
