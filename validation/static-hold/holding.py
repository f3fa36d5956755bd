"""Displacement, drift and friction of a block that friction must hold.

Closed form (Coulomb): a block at rest on an incline stays at rest if tan θ ≤ μ; friction then is T = m g sin
θ, so T / N = tan θ, below μ."""

import numpy as np
import xarray as xr
from incline import forces

HEIGHT = 0.3  # of the block [m]


def displacement(run: xr.DataTree) -> float:
    """Of the block's centre at the end, over its height."""
    return float(np.hypot(*_moved(run["series"].to_dataset())[-1])) / HEIGHT


def creep(run: xr.DataTree) -> dict[str, float]:
    """Largest distance of the block's centre from where it began, ``way``, and how far that changes after the
    first fifth of the time, ``later``, both in cells."""
    centre = run["series"].to_dataset()["centre_of_mass"].sel(body="block").values
    way = np.linalg.norm(centre - centre[0], axis=1) / float(run.attrs["cell_size"])
    return {"way": float(way.max()), "later": float(np.ptp(way[len(way) // 5 :]))}


def drift(run: xr.DataTree) -> float:
    """Slope of the line fitted to the way along the plane in the last second, over the height [1/s]."""
    series = run["series"].to_dataset()
    time, last = series["time"].values, _last_second(series)
    return float(np.polyfit(time[last], _moved(series)[last, 0], 1)[0]) / HEIGHT


def friction(run: xr.DataTree) -> float | None:
    """T / N in the last second; None without a contact force."""
    series = run["series"].to_dataset()
    found = forces(series, _last_second(series))
    return None if found is None else found[0] / found[1]


def _last_second(series: xr.Dataset) -> np.ndarray:
    time = series["time"].values
    return np.asarray(time >= time[-1] - 1.0)


def _moved(series: xr.Dataset) -> np.ndarray:
    """Displacement of the block's centre, (time, axis) [m]."""
    centre = series["centre_of_mass"].sel(body="block").values
    return centre - centre[0]
