"""Contact pressure of the cylinder, by nodal forces and by the stress of points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import xarray as xr

if TYPE_CHECKING:
    from mpmfw.validation import CaseRun

Array = npt.NDArray[np.float64]

RADIUS, CENTRE = 1.0, 0.011  #: of the cylinder, and abscissa of its centre [m]
WEIGHT = 1000.0 * 10.0 * np.pi * RADIUS**2  #: F' [N/m]
YOUNG, POISSON = 1.6e6, 0.3  #: of the cylinder; the plane's E is 1000 times that
#: 1/E* = (1 − ν²)/E of the cylinder + (1 − ν²)/E of the plane [Pa]
E_STAR = YOUNG / (1.0 - POISSON**2) / (1.0 + 1e-3)
#: Hertz: half-width of the contact [m] and largest pressure [Pa]; K. L. Johnson, Contact Mechanics (1985),
#: section 4.2(c)
HALF_WIDTH = float(np.sqrt(4.0 * WEIGHT * RADIUS / (np.pi * E_STAR)))
PEAK = float(np.sqrt(WEIGHT * E_STAR / (np.pi * RADIUS)))


@dataclass(frozen=True)
class Profile:
    """Contact pressure averaged over windows of one cell."""

    x: Array  #: from the centre [m]
    pressure: Array  #: [Pa]
    cell_size: float  #: [m]
    touching: float = np.nan  #: half the distance between the outermost nodes that carry force [m]
    force: float = np.nan  #: sum of the contact forces [N/m]

    @property
    def peak_error(self) -> float:
        """Largest pressure against p0 [%]."""
        return float(100.0 * (self.pressure.max() / PEAK - 1.0))

    @property
    def fit(self) -> tuple[float, float]:
        """(p0 [Pa], b [m]) of p² = p0² (1 − x²/b²), by windows above a fifth of the peak."""
        chosen = self.pressure > 0.2 * self.pressure.max()
        if chosen.sum() < 3:
            return np.nan, np.nan
        slope, level = np.polyfit(self.x[chosen] ** 2, self.pressure[chosen] ** 2, 1)
        if level <= 0.0 or slope >= 0.0:
            return np.nan, np.nan
        return float(np.sqrt(level)), float(np.sqrt(-level / slope))

    @property
    def fitted_peak_error(self) -> float:
        """p0 of the fit [%]."""
        return 100.0 * (self.fit[0] / PEAK - 1.0)

    @property
    def width_error(self) -> float:
        """b of the fit [cells]."""
        return (self.fit[1] - HALF_WIDTH) / self.cell_size

    @property
    def touching_error(self) -> float:
        """Half-width from the nodes that carry force [cells]."""
        return (self.touching - HALF_WIDTH) / self.cell_size


def from_forces(tree: xr.DataTree) -> Profile:
    """Pressure from contact forces over tributary length; the penalty contact stores them."""
    surface = tree["surface/cylinder"].to_dataset().isel(time=-1)
    h = float(tree.attrs["cell_size"])
    position, force = surface["position"].values, surface["force"].values[:, 1]
    after = surface["next"].values
    length = np.linalg.norm(position[after] - position, axis=1)
    tributary = 0.5 * length
    np.add.at(tributary, after, 0.5 * length)
    low = position[:, 1] < 0.5 * RADIUS
    x, force, tributary = position[low, 0] - CENTRE, force[low], tributary[low]
    windows, pressure = _averages(x, force, tributary, h)
    active = x[force > 0.0]
    touching = 0.5 * float(np.ptp(active)) if len(active) else np.nan
    return Profile(windows, pressure, h, touching, float(force.sum()))


def from_stress(tree: xr.DataTree) -> Profile:
    """Return the pressure as −σ_yy of points within half a cell of the rim, weighted by volume."""
    points = tree["particles/cylinder"].to_dataset()
    start, end = points.isel(time=0), points.isel(time=-1)
    h = float(tree.attrs["cell_size"])
    # Told by position within the undeformed disc: settled by far less than a cell outside the contact
    rest = end["position"].values
    depth = rest[:, 1] - _lower_rim(tree, rest[:, 0])
    rim = (depth < 0.5 * h) & (rest[:, 1] < 0.5 * RADIUS)
    volume = start["volume"].values[rim]
    load = -end["stress"].values[rim, 1, 1] * volume
    windows, pressure = _averages(rest[rim, 0] - CENTRE, load, volume, h)
    return Profile(windows, pressure, h)


def of_forces(tree: xr.DataTree) -> dict[str, float]:
    """Return errors: ``peak``, ``fitted peak`` and ``load`` [%], ``width`` and ``touching`` [cells]."""
    profile = from_forces(tree)
    return {
        "peak": profile.peak_error,
        "fitted peak": profile.fitted_peak_error,
        "width": profile.width_error,
        "touching": profile.touching_error,
        "load": 100.0 * (profile.force / WEIGHT - 1.0),
    }


def of_stress(tree: xr.DataTree) -> dict[str, float]:
    """Errors by the stress: ``peak`` [%] and ``width`` [cells]."""
    profile = from_stress(tree)
    return {"peak": profile.peak_error, "width": profile.width_error}


def orders(runs: Sequence[CaseRun]) -> dict[str, float]:
    """Return observed orders, and the ``most`` that an error is over that of the coarser cells.

    Errors below 1 % count as 1 %: they depend on where the contact lies in its cell.
    """
    profiles = sorted((from_forces(run.results) for run in runs), key=lambda one: -one.cell_size)
    sizes = np.array([one.cell_size for one in profiles])
    errors = {
        "peak": np.abs([one.peak_error for one in profiles]),
        "fitted peak": np.abs([one.fitted_peak_error for one in profiles]),
        "width": np.abs([one.width_error * one.cell_size for one in profiles]),
    }
    counted = np.maximum(errors["peak"], 1.0)
    most = float(np.max(counted[1:] / counted[:-1]))
    return {**{name: observed_order(sizes, error) for name, error in errors.items()}, "most": most}


def _lower_rim(tree: xr.DataTree, x: Array) -> Array:
    """Height of the cylinder's deformed underside [m]."""
    rim = tree["surface/cylinder"]["position"].values[-1]
    low = rim[rim[:, 1] < 0.5 * RADIUS]
    order = np.argsort(low[:, 0])
    return np.asarray(np.interp(x, low[order, 0], low[order, 1]))


def _averages(x: Array, load: Array, size: Array, h: float) -> tuple[Array, Array]:
    """Σ load / Σ size over windows of one cell, centred on x = 0, within 4 half-widths."""
    window = np.floor(x / h + 0.5).astype(int)
    numbers = [k for k in np.unique(window) if abs(k * h) < 4.0 * HALF_WIDTH]
    chosen = [window == k for k in numbers]
    centre = np.array([np.average(x[own], weights=size[own]) for own in chosen])
    return centre, np.array([load[own].sum() / size[own].sum() for own in chosen])


def observed_order(cell_sizes: Array, errors: Array) -> float:
    """Slope of the least-squares line of log(error) over log(cell size)."""
    return float(np.polyfit(np.log(cell_sizes), np.log(np.abs(errors)), 1)[0])
