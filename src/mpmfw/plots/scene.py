"""Figures of a comparison on any scene: motion, forces, gaps and energies."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from mpmfw.plots.histories import history
from mpmfw.plots.style import at_last
from mpmfw.results.analysis import energy_sums
from mpmfw.results.references import cell_size

#: Bodies that move no further than this part of the largest motion stand still.
_STILL = 1e-2
#: Rows of a figure: the bodies that move farthest, the pairs with the largest forces.
MOST = 6
#: Top of the gap's history, in cells.
LARGEST_GAP = 3.0


def moving_bodies(dataset: xr.Dataset) -> list[str]:
    """Return the bodies that move, the farthest first."""
    centre = dataset["centre_of_mass"]
    away = centre - centre.isel(time=0)
    far = _largest(_size(away, away), "body")
    return [str(name) for name in far["body"].values[far.values > _STILL * far.values.max()]]


def touching_pairs(dataset: xr.Dataset) -> list[str]:
    """Return the pairs with a contact force in any run, largest first."""
    force = _largest(dataset["contact_force"], "pair")
    return [str(name) for name in force["pair"].values[force.values > 0.0]]


def _largest(array: xr.DataArray, dim: str) -> xr.DataArray:
    """Return the largest magnitude for each label, the largest first."""
    size = abs(array).where(np.isfinite(array))
    size = size.max([one for one in size.dims if one != dim]).fillna(0.0)
    return size.isel({dim: np.argsort(-size.values, kind="stable")})


def near_pairs(dataset: xr.Dataset) -> list[str]:
    """Return the pairs that come within so many cells."""
    h, gap = cell_size(at_last(dataset)), at_last(dataset)["min_gap"]
    near = (gap < (LARGEST_GAP * h if h > 0.0 else np.inf)).any([dim for dim in gap.dims if dim != "pair"])
    return [str(name) for name in dataset["pair"].values[near.values]]


def body_motion(dataset: xr.Dataset) -> Figure:
    """Draw displacement and spin of each body that moves."""
    centre = dataset["centre_of_mass"]
    displacement = (centre - centre.isel(time=0)).assign_attrs(units="m")
    shown = dataset.assign(displacement=displacement).sel(body=moving_bodies(dataset)[:MOST])
    return history(shown, ["displacement", *(["angular_velocity"] if "angular_velocity" in dataset else [])])


def pair_forces(dataset: xr.Dataset) -> Figure:
    """Draw the normal and the tangential force of every pair that touches."""
    shown = dataset.sel(pair=touching_pairs(dataset)[:MOST])
    force = shown["contact_force"]
    if "friction_force" not in dataset:
        return history(shown.assign(contact_force_size=_size(force, force)), "contact_force_size")
    along = shown["friction_force"]
    parts = {"normal_force": _size(force - along, force), "tangential_force": _size(along, force)}
    return history(shown.assign(parts), list(parts))


def gap_history(dataset: xr.Dataset) -> Figure:
    """Draw the gap of every pair that comes near."""
    h = cell_size(at_last(dataset))
    known = h > 0.0
    shown = dataset.sel(pair=near_pairs(dataset)[:MOST] or dataset["pair"].values[:1])
    gap = (shown["min_gap"] / (h if known else 1.0)).assign_attrs(units="cells" if known else "m")
    figure = history(shown.assign(gap=gap), "gap")
    for axes in figure.axes:
        axes.axhline(0.0, color="black", linewidth=0.6)
        if known:  # bodies that have flown apart would hide what happens in contact
            axes.set_ylim(top=min(axes.get_ylim()[1], LARGEST_GAP))
    return figure


def energies(dataset: xr.Dataset) -> Figure:
    """Kinetic, strain and dissipated energy of all bodies over time."""
    unit = dataset["kinetic_energy"].attrs.get("units", "J")
    sums = energy_sums(dataset)
    shown = dataset.assign({name: total.assign_attrs(units=unit) for name, total in sums.items()})
    return history(shown, list(sums))


def _size(force: xr.DataArray, of: xr.DataArray) -> xr.DataArray:
    size = (force**2).sum("axis", skipna=False) ** 0.5
    return size.assign_attrs(units=of.attrs.get("units", "N"))
