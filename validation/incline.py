"""Friction and normal force between a block and the plane below it."""

import math

import numpy as np
import xarray as xr

TILT, FRICTION, GRAVITY = math.radians(30.0), 0.3, 10.0  #: of the sliding block [rad], [1], [m/s²]
NORMAL_FORCE = 1000.0 * 0.6 * 0.3 * GRAVITY * math.cos(TILT)  #: on a rigid one, m g cos θ [N/m]
#: The share of the sliding block's motion that is judged: the start, when the tilt is sudden, is left out.
FROM = 0.2


def forces(series: xr.Dataset, late: np.ndarray) -> tuple[float, float] | None:
    """Return the means of T, against the motion, and of N on the block where ``late`` (time,) [N/m].

    None without a contact force: what one velocity field exchanges is not told from internal force.
    """
    if "contact_force" not in series:
        return None
    force = series["contact_force"].sel(pair="block-plane")[late].mean("time")
    return -float(force.sel(axis="x")), float(force.sel(axis="y"))


def sliding(run: xr.DataTree) -> dict[str, float | None]:
    """Return ``friction``, the error of mean T over μ times mean N, and ``normal``, mean N over m g cos θ."""
    series = run["series"].to_dataset()
    time = series["time"].values
    found = forces(series, time > FROM * time[-1])
    if found is None:
        return {"friction": None, "normal": None}
    tangential, normal = found
    return {"friction": tangential / (FRICTION * normal) - 1.0, "normal": normal / NORMAL_FORCE}
