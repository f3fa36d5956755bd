"""How far a block has slid under a rising tangential load, and when.

Closed form (Coulomb, rigid block): T = m r t sticks until T = μ N = μ m g, at t_s = μ g / r. From then on the
block's acceleration is r (t − t_s), so it has slid r (t − t_s)³ / 6, and passes the distance s at t_s + (6 s
/ r)^(1/3)."""

import numpy as np
import xarray as xr
from incline import forces

from mpmfw.results.stored_scene import scene_of

FRICTION, GRAVITY = 0.3, 10.0  # [1], [m/s²]
LENGTH = 0.6  # of the block [m]
THRESHOLD = 1e-3 * LENGTH  # of sliding [m]


def rate_of(run: xr.DataTree) -> float:
    """Of the tangential load per mass, from the scene's table of gravity [m/s³]."""
    last = scene_of(run.attrs)["gravity"]["table"][-1]
    return float(last[1] / last[0])


def time_of_slip(run: xr.DataTree) -> float:
    """Error of the time at which the threshold is slid, over the time at which slip begins."""
    rate = rate_of(run)
    start = FRICTION * GRAVITY / rate
    expected = start + (6.0 * THRESHOLD / rate) ** (1.0 / 3.0)
    return (_passes(run["series"]["time"].values, sliding(run)) - expected) / start


def slid_before(run: xr.DataTree) -> float | None:
    """Return the slip at 0.9 of the slip load over the threshold [%]; None of a run that ends before."""
    time, start = run["series"]["time"].values, FRICTION * GRAVITY / rate_of(run)
    if time[-1] < start:
        return None
    return 100.0 * float(np.interp(0.9 * start, time, sliding(run))) / THRESHOLD


def friction_at_end(run: xr.DataTree) -> float | None:
    """T / N of the last 0.05 s; None without a contact force, or of a run that ends before slip begins."""
    series = run["series"].to_dataset()
    time = series["time"].values
    found = forces(series, time >= time[-1] - 0.05)
    return None if found is None or time[-1] < FRICTION * GRAVITY / rate_of(run) else found[0] / found[1]


def sliding(run: xr.DataTree) -> np.ndarray:
    """Return the mean displacement of the block's lower face over that of the plane below it [m], (time,)."""
    block = run["surface/block"]["position"].values
    plane = run["surface/plane"]["position"].values
    lower = np.isclose(block[0, :, 1], block[0, :, 1].min(), atol=0.01 * LENGTH)
    left, right = block[0, lower, 0].min(), block[0, lower, 0].max()
    upper = np.isclose(plane[0, :, 1], plane[0, :, 1].max(), atol=0.01 * LENGTH)
    upper &= (plane[0, :, 0] >= left) & (plane[0, :, 0] <= right)
    relative = block[:, lower, 0].mean(1) - plane[:, upper, 0].mean(1)
    return np.asarray(relative - relative[0])


def _passes(time: np.ndarray, slid: np.ndarray) -> float:
    """When the threshold is exceeded first, linear between outputs [s]; NaN if it is not."""
    over = np.flatnonzero(slid > THRESHOLD)
    if len(over) == 0:
        return float("nan")
    k = over[0]
    return float(np.interp(THRESHOLD, slid[k - 1 : k + 1], time[k - 1 : k + 1]))
