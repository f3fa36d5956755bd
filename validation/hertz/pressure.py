"""Contact pressure of the cylinder, by nodal forces and by the stress of points."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from convergence import observed_order
from surface_pressure import nodes_of

from mpmfw.validation import CaseRun

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
    """Contact pressure averaged over windows of one cell, within 4 half-widths of the centre."""

    x: np.ndarray  #: from the centre [m]
    pressure: np.ndarray  #: [Pa]
    cell_size: float  #: [m]

    @property
    def errors(self) -> dict[str, float]:
        """Errors of the ``peak`` and of p0, ``fitted peak`` [%], and of b, ``width`` [cells].

        p² = p0² (1 − x²/b²) is fitted to windows above a fifth of the peak."""
        peak, width = np.nan, np.nan
        chosen = self.pressure > 0.2 * self.pressure.max()
        if chosen.sum() >= 3:
            slope, level = np.polyfit(self.x[chosen] ** 2, self.pressure[chosen] ** 2, 1)
            if level > 0.0 and slope < 0.0:
                peak, width = np.sqrt(level), np.sqrt(-level / slope)
        return {
            "peak": float(100.0 * (self.pressure.max() / PEAK - 1.0)),
            "fitted peak": float(100.0 * (peak / PEAK - 1.0)),
            "width": float(width - HALF_WIDTH) / self.cell_size,
        }


def of_forces(tree: xr.DataTree) -> dict[str, float]:
    """Return errors of the profile by contact forces over tributary length.

    Besides, that of the ``load`` [%], and of half the distance between the outermost nodes that carry force,
    ``touching`` [cells]."""
    position, force, length = nodes_of(tree, "cylinder", -1)
    low, h = position[:, 1] < 0.5 * RADIUS, float(tree.attrs["cell_size"])
    x, force = position[low, 0] - CENTRE, force[low, 1]
    profile = _profile(x, force, length[low], h)
    active = x[force > 0.0]
    touching = 0.5 * float(np.ptp(active)) if len(active) else np.nan
    return {
        **profile.errors,
        "touching": (touching - HALF_WIDTH) / h,
        "load": 100.0 * (float(force.sum()) / WEIGHT - 1.0),
    }


def of_stress(tree: xr.DataTree) -> dict[str, float]:
    """Return errors of the profile by −σ_yy of points within half a cell of the rim, weighted by volume."""
    points, h = tree["particles/cylinder"].to_dataset(), float(tree.attrs["cell_size"])
    end = points.isel(time=-1)
    position = end["position"].values
    # The deformed underside: settled by far less than a cell outside the contact
    rim = tree["surface/cylinder"]["position"].values[-1]
    rim = rim[rim[:, 1] < 0.5 * RADIUS]
    rim = rim[np.argsort(rim[:, 0])]
    depth = position[:, 1] - np.interp(position[:, 0], rim[:, 0], rim[:, 1])
    near = (depth < 0.5 * h) & (position[:, 1] < 0.5 * RADIUS)
    volume = points["volume"].isel(time=0).values[near]
    load = -end["stress"].values[near, 1, 1] * volume
    return _profile(position[near, 0] - CENTRE, load, volume, h).errors


def _profile(x: np.ndarray, load: np.ndarray, size: np.ndarray, h: float) -> Profile:
    """Σ load / Σ size over windows of one cell, centred on x = 0."""
    window = np.floor(x / h + 0.5).astype(int)
    chosen = [window == k for k in np.unique(window) if abs(k * h) < 4.0 * HALF_WIDTH]
    centre = np.array([np.average(x[own], weights=size[own]) for own in chosen])
    return Profile(centre, np.array([load[own].sum() / size[own].sum() for own in chosen]), h)


def by_size(runs: Sequence[CaseRun]) -> dict[str, np.ndarray]:
    """Return cell sizes as ``h``, from the largest on [m], and magnitudes of the errors by forces."""
    ordered = sorted(runs, key=lambda run: -run.results.attrs["cell_size"])
    found = {
        key: np.abs([run.of(of_forces, key) for run in ordered]) for key in ("peak", "fitted peak", "width")
    }
    sizes = np.array([float(run.results.attrs["cell_size"]) for run in ordered])
    return {"h": sizes, **found, "width": found["width"] * sizes}


def orders(runs: Sequence[CaseRun]) -> dict[str, float]:
    """Return observed orders, and the ``most`` that an error is over that of the coarser cells.

    Errors below 1 % count as 1 %: they depend on where the contact lies in its cell.
    """
    errors = by_size(runs)
    sizes, counted = errors.pop("h"), np.maximum(errors["peak"], 1.0)
    most = float(np.max(counted[1:] / counted[:-1]))
    return {**{name: observed_order(sizes, error) for name, error in errors.items()}, "most": most}
