"""The sliding block, as the case ``sliding-block`` measures it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mpmfw.results.analysis import fitted_acceleration

if TYPE_CHECKING:
    import xarray as xr

TILT, FRICTION, GRAVITY = math.radians(30.0), 0.3, 10.0  # [rad], [1], [m/s²]
#: Rigid block under Coulomb friction: a = g (sin θ − μ cos θ) [m/s²].
ACCELERATION = GRAVITY * (math.sin(TILT) - FRICTION * math.cos(TILT))
FROM = 0.2  #: share of the motion that is left out


def acceleration_error(series: xr.Dataset) -> float:
    """Of the acceleration fitted to the block's centre [%]."""
    time = series["time"].values
    x = series["centre_of_mass"].sel(body="block", axis="x").values
    fitted = fitted_acceleration(time, x - x[0], FROM * time[-1], time[-1])
    return 100.0 * (fitted / ACCELERATION - 1.0)


def friction_error(run: xr.DataTree) -> float:
    """Of mean T over μ times mean N [%]."""
    series = run["series"].to_dataset()
    time = series["time"].values
    force = series["contact_force"].sel(pair="block-plane")[time > FROM * time[-1]].mean("time")
    return 100.0 * (-float(force.sel(axis="x")) / (FRICTION * float(force.sel(axis="y"))) - 1.0)
