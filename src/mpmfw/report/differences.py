"""Quantities at the end of runs, and how far methods differ in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr

from mpmfw.errors import is_complete
from mpmfw.plots.style import at_last
from mpmfw.results.analysis import GAP_ROUND_OFF, energy_sums, without_round_off
from mpmfw.results.selection import points_of
from mpmfw.results.stored_scene import cell_size
from mpmfw.state.fields import FloatArray


@dataclass(frozen=True)
class Difference:
    """A quantity at the end of the runs."""

    quantity: str  #: with its body or pair
    unit: str
    values: FloatArray  #: (contact, shape); NaN for a run that did not end
    scale: float  #: reference size of a difference, in the same unit
    against: str  #: name of the scale

    @property
    def spread(self) -> float:
        """Largest minus smallest value, over the scale."""
        known = self.values[np.isfinite(self.values)]
        return float(np.ptp(known) / self.scale) if len(known) > 1 and self.scale > 0.0 else 0.0


def differences(dataset: xr.Dataset) -> list[Difference]:
    """Return final quantities, those in which methods differ most first."""
    last = at_last(without_round_off(dataset))
    return sorted(_quantities(last), key=lambda one: -one.spread)


def _unit(whole: str, array: xr.DataArray) -> str:
    """Return the unit, per metre if that of the ``array`` is."""
    return f"{whole}/m" if array.attrs.get("units", "").endswith(" m-1") else whole


def _quantities(runs: xr.Dataset) -> Iterator[Difference]:
    if "centre_of_mass" in runs:
        centre, velocity = runs["centre_of_mass"], runs["mean_velocity"]
        moved = centre - centre.isel(time=0)
        yield from _each("displacement", "m", moved, moved.isel(time=-1), "largest displacement of any body")
        yield from _each("velocity", "m/s", velocity, velocity.isel(time=-1), "largest velocity of any body")
        if "angular_velocity" in runs:
            spin = runs["angular_velocity"]
            yield from _each("spin", "rad/s", spin, spin.isel(time=-1), "largest spin of any body")
    if "kinetic_energy" in runs and "strain_energy" in runs:
        yield from _energies(runs, _unit("J", runs["kinetic_energy"]))
    if "contact_force" in runs:
        steps = xr.DataArray(np.diff(runs["time"], prepend=runs["time"][:1]), {"time": runs["time"]})
        impulse = (runs["contact_force"].fillna(0.0) * steps).sum("time")
        end = impulse.where(_ended(runs))
        yield from _each(
            "impulse", _unit("N s", runs["contact_force"]), impulse, end, "largest impulse of any pair"
        )
    if "min_gap" in runs:
        h, depth = cell_size(runs), (-runs["min_gap"]).clip(min=0.0).fillna(0.0).max("time")
        depth = depth.where(depth >= GAP_ROUND_OFF * h, 0.0).where(_ended(runs) & ~_of_codes(runs))
        yield from _each("largest penetration", "m", h, depth, "a cell")


def _each(
    what: str, unit: str, scale: xr.DataArray | float, end: xr.DataArray, against: str
) -> Iterator[Difference]:
    """Yield a quantity at the end of the runs; its scale is a number or the largest of the values
    ``scale``."""
    size = scale if isinstance(scale, float) else _largest(scale)
    dims = [dim for dim in end.dims if dim not in ("contact", "shape")]
    for labels, one in points_of(end.to_dataset(name="end"), dims):
        owner, *axis = labels.values()
        values = one["end"].transpose("contact", "shape").values.astype(float)
        yield Difference(", ".join([f"{owner}: {what}", *axis]), unit, values, size, against)


def _energies(runs: xr.Dataset, unit: str) -> Iterator[Difference]:
    own, sums = ~_of_codes(runs), energy_sums(runs)
    scale = _largest(sums["kinetic_energy"] + sums["strain_energy"])
    for name, energy in sums.items():
        words = "dissipated by contact" if name == "dissipated_energy" else name.replace("_", " ")
        last = energy.isel(time=-1)
        last = last.where(own) if name == "dissipated_energy" else last
        end = last.transpose("contact", "shape").values
        yield Difference(words, unit, end, scale, "largest kinetic and strain energy")


def _largest(array: xr.DataArray) -> float:
    size = np.abs(array.values[np.isfinite(array.values)])
    return float(size.max(initial=0.0))


def _ended(runs: xr.Dataset) -> xr.DataArray:
    status = runs["status"]
    return status.copy(data=np.vectorize(is_complete, otypes=[bool])(status.values))


def _of_codes(runs: xr.Dataset) -> xr.DataArray:
    """Return True for runs of other codes, which measure neither gaps nor works."""
    return runs["code"] != "" if "code" in runs else xr.zeros_like(runs["status"], dtype=bool)
