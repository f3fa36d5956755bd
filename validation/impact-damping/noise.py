"""Noise of a force, and where the energy goes, of a run and of the finite elements."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
import xarray as xr
from rings import force_of, reference_impulse

from mpmfw.results.analysis import averaged, energy_kept, impulse, relative_l2
from mpmfw.results.references import rings_table
from mpmfw.state.fields import FloatArray

WINDOW = 100e-6  #: of the mean against which noise is told [s]
SHORT = 25e-6  #: of the mean that leaves only what changes from node to node [s]
INTERVAL = 5e-6  #: over which the raw force is a mean [s]


@dataclass(frozen=True)
class Found:
    """What one run did; energies relative to the start, NaN where they are not known."""

    time: FloatArray  #: [s]
    force: FloatArray  #: on the right ring, mean over INTERVAL [N/m]
    noise: float  #: rms of the raw force less its mean over WINDOW, relative to the rms of that mean
    jitter: float  #: the same of the raw force less its mean over SHORT
    errors: dict[int, float]  #: relative L2 error of the force by averaging window [µs]
    lost: float = math.nan  #: kinetic, affine and strain energy that is gone at the end
    damping: float = math.nan  #: of it into contact dashpots
    transfer: float = math.nan  #: of it lost between material points and grid
    most: float = math.nan  #: largest energy and dissipation together
    least_damping: float = math.nan  #: smallest increment of the damping work
    rebound: float = math.nan  #: mean velocity of a ring at the end [m/s]
    momentum: float = math.nan  #: drift of linear momentum, relative


def noise_of(time: FloatArray, force: FloatArray, window: float = WINDOW) -> float:
    """What a mean over ``window`` [s] leaves out, by rms, relative to the mean over WINDOW."""
    away = force - averaged(time, impulse(time, force), window)
    return float(np.sqrt(np.mean(away**2) / np.mean(averaged(time, impulse(time, force), WINDOW) ** 2)))


def found_of(tree: xr.DataTree) -> Found:
    """Force and energies of a run."""
    series = tree["series"].to_dataset()
    time, force = force_of(series)
    start = float(series["kinetic_energy"].isel(time=0).sum())
    kept = energy_kept(series)
    works = {name: series[name].sum("pair").values / start for name in ("damping_work", "frictional_work")}
    springs = float(series["contact_energy"].isel(time=-1).sum()) / start
    momentum = series["linear_momentum"]
    velocity = series["mean_velocity"].sel(axis="x").isel(time=-1)
    return Found(
        time,
        force,
        noise_of(time, force),
        noise_of(time, force, SHORT),
        _errors(time, impulse(time, force)),
        lost=1.0 - float(kept[-1] - springs - sum(work[-1] for work in works.values())),
        damping=float(works["damping_work"][-1]),
        transfer=float(series["transfer_dissipation"].isel(time=-1)) / start,
        most=float(kept.max()),
        least_damping=float(np.diff(works["damping_work"]).min()),
        rebound=0.5 * float(velocity.sel(body="right") - velocity.sel(body="left")),
        momentum=float(
            np.abs((momentum - momentum.isel(time=0)).sum("body")).max() / np.abs(momentum.isel(time=0)).max()
        ),
    )


def of_finite_elements(run: str) -> Found:
    """The shipped ``fine`` or ``coarse`` force, as a mean over the same intervals."""
    table = rings_table("force")
    time = INTERVAL * np.arange(641, dtype=np.float64)
    impulses = np.interp(time, table["time"], table[f"{run}_impulse_Ns_per_m"])
    force: FloatArray = np.diff(impulses, prepend=impulses[0]) / INTERVAL
    noise, jitter = noise_of(time, force), noise_of(time, force, SHORT)
    return Found(time, force, noise, jitter, _errors(time, impulses))


def _errors(time: FloatArray, impulses: FloatArray) -> dict[int, float]:
    exact = reference_impulse(time)
    return {
        window: relative_l2(time, *(averaged(time, one, 1e-6 * window) for one in (impulses, exact)))
        for window in (50, 100, 200)
    }


def of_run(tree: xr.DataTree) -> dict[str, float]:
    """Return the numbers of :class:`Found`, errors of the force under their window [µs]."""
    return _numbers(found_of(tree))


def of_elements(run: str) -> dict[str, float]:
    """Return the same of the ``fine`` or ``coarse`` finite elements, whose energies are not known."""
    return _numbers(of_finite_elements(run))


def _numbers(found: Found) -> dict[str, float]:
    fields = {field.name: getattr(found, field.name) for field in dataclasses.fields(found)}
    numbers = {name: value for name, value in fields.items() if isinstance(value, float)}
    return {**numbers, **{str(window): error for window, error in found.errors.items()}}
