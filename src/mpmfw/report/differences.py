"""What a comparison's methods disagree about: one number for each body and pair, largest difference first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr

from mpmfw.errors import is_complete
from mpmfw.plots.style import at_last
from mpmfw.results.references import cell_size
from mpmfw.results.round_off import without_round_off
from mpmfw.state.fields import FloatArray


@dataclass(frozen=True)
class Difference:
    """A quantity at the end of the runs.

    Parameters
    ----------
    quantity, unit
        What it is of which body or pair.
    values
        One for each contact and shape, (contact, shape); NaN of a run that did not end.
    scale
        What a difference is measured against, in the same unit; ``against`` says what it is.
    """

    quantity: str
    unit: str
    values: FloatArray
    scale: float
    against: str

    @property
    def spread(self) -> float:
        """Largest less least value, over the scale; 0 where fewer than two are known."""
        known = self.values[np.isfinite(self.values)]
        return float(np.ptp(known) / self.scale) if len(known) > 1 and self.scale > 0.0 else 0.0


def differences(dataset: xr.Dataset) -> list[Difference]:
    """Quantities of a comparison by how far its methods differ in them, the largest difference first.

    Parameters
    ----------
    dataset
        Of ``compare``; of varied keys the last value counts.
    """
    last = at_last(without_round_off(dataset))
    return sorted(_quantities(last), key=lambda one: -one.spread)


def refinement(dataset: xr.Dataset) -> dict[tuple[str, str], tuple[str, float]]:
    """By how much the finest cells changed each method: the quantity that changed most, and its change over
    its scale.

    Empty where cells of one size alone were run.
    """
    if dataset.sizes.get("cell_size", 0) < 2:
        return {}
    by_size = dataset.sortby("cell_size", ascending=False)
    coarse, fine = (
        {one.quantity: one for one in _quantities(at_last(by_size.isel(cell_size=slice(0, end))))}
        for end in (-1, None)
    )
    changed = {}
    for a, contact in enumerate(dataset["contact"].values):
        for b, shape in enumerate(dataset["shape"].values):
            moved = {
                name: abs(one.values[a, b] - coarse[name].values[a, b]) / one.scale
                for name, one in fine.items()
                if name in coarse and one.scale > 0.0
            }
            known = {name: float(change) for name, change in moved.items() if np.isfinite(change)}
            if known:
                largest = max(known, key=lambda name: known[name])
                changed[str(contact), str(shape)] = (largest, known[largest])
    return changed


def _quantities(runs: xr.Dataset) -> Iterator[Difference]:
    if "centre_of_mass" in runs:
        yield from _motion(runs)
    if "kinetic_energy" in runs and "strain_energy" in runs:
        yield from _energies(runs)
    if "contact_force" in runs:
        yield from _impulses(runs)
    if "min_gap" in runs:
        depth = np.maximum(-_ordered(runs["min_gap"], "time", "pair"), 0.0)
        for k, pair in enumerate(runs["pair"].values):
            largest = _of_ended(runs, np.nan_to_num(depth[:, :, :, k]).max(axis=2))
            yield Difference(f"{pair}: largest penetration", "m", largest, cell_size(runs), "a cell")


def _motion(runs: xr.Dataset) -> Iterator[Difference]:
    """Displacement and velocity of every body at the end, along each axis, and spin."""
    centre = _ordered(runs["centre_of_mass"], "time", "body", "axis")
    moved = centre - centre[:, :, :1]
    velocity = _ordered(runs["mean_velocity"], "time", "body", "axis")
    for what, unit, array, against in (
        ("displacement", "m", moved, "largest displacement of any body"),
        ("velocity", "m/s", velocity, "largest velocity of any body"),
    ):
        for k, body in enumerate(runs["body"].values):
            for d, axis in enumerate(runs["axis"].values):
                yield Difference(
                    f"{body}: {what}, {axis}", unit, array[:, :, -1, k, d], _largest(array), against
                )
    if "angular_velocity" in runs:
        spin = _ordered(runs["angular_velocity"], "time", "body", "rotation")
        for k, body in enumerate(runs["body"].values):
            for d, axis in enumerate(runs["rotation"].values):
                yield Difference(
                    f"{body}: spin, {axis}",
                    "rad/s",
                    spin[:, :, -1, k, d],
                    _largest(spin),
                    "largest spin of any body",
                )


def _energies(runs: xr.Dataset) -> Iterator[Difference]:
    """Energy of each kind at the end, of the largest mechanical energy at any time."""
    kinetic, strain = (
        _ordered(runs[name], "time", "body").sum(axis=3) for name in ("kinetic_energy", "strain_energy")
    )
    scale, against = _largest(kinetic + strain), "largest kinetic and strain energy"
    unit = "J/m" if runs.sizes["axis"] == 2 else "J"
    yield Difference("kinetic energy", unit, kinetic[:, :, -1], scale, against)
    yield Difference("strain energy", unit, strain[:, :, -1], scale, against)
    works = [name for name in ("frictional_work", "damping_work", "spring_work") if name in runs]
    if works:
        taken = np.sum([np.nan_to_num(_ordered(runs[name], "time", "pair")) for name in works], axis=0).sum(
            axis=3
        )
        yield Difference("dissipated by contact", unit, _of_ended(runs, taken[:, :, -1]), scale, against)


def _impulses(runs: xr.Dataset) -> Iterator[Difference]:
    """Impulse of every pair up to the end, along each axis."""
    force = np.nan_to_num(_ordered(runs["contact_force"], "time", "pair", "axis"))
    steps = np.diff(runs["time"].values, prepend=runs["time"].values[:1])
    impulse = (force * steps[:, None, None]).sum(axis=2)
    unit = "N s/m" if runs.sizes["axis"] == 2 else "N s"
    for k, pair in enumerate(runs["pair"].values):
        for d, axis in enumerate(runs["axis"].values):
            total = _of_ended(runs, impulse[:, :, k, d])
            yield Difference(
                f"{pair}: impulse, {axis}", unit, total, _largest(impulse), "largest impulse of any pair"
            )


def _ordered(array: xr.DataArray, *dims: str) -> FloatArray:
    return np.asarray(array.transpose("contact", "shape", *dims).values, dtype=float)


def _largest(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(np.abs(known).max()) if len(known) else 0.0


def _of_ended(runs: xr.Dataset, values: FloatArray) -> FloatArray:
    """The values of runs that came to their end; NaN of others."""
    status = runs["status"].transpose("contact", "shape").values
    ended = np.vectorize(is_complete, otypes=[bool])(status)
    return np.where(ended, values, np.nan)
