"""Relative errors of a run's energy and momentum."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from mpmfw.scene import Scene

#: Series whose sum is the error in time: residuals without the work of velocities' half step.
_RESIDUALS = (
    (1.0, "energy_residual"),
    (-1.0, "half_step_work"),
    (1.0, "contact_residual"),
    (-1.0, "contact_half_step_work"),
)

#: Series of energies and of their accounted losses.
_BY_BODY = (
    "kinetic_energy", "affine_energy", "strain_energy", "material_dissipation", "viscous_dissipation",
)  # fmt: skip
_BY_PAIR = ("contact_energy", "frictional_work")


def energy_error(run: xr.DataTree, scene: Scene) -> float:
    """Return the largest error of strain and contact energy, relative to the energy put in."""
    series = run["series"].to_dataset()
    if "energy_residual" not in series:
        return float("nan")
    residual = sum(sign * series[name].values for sign, name in _RESIDUALS if name in series)
    put_in = energy_put_in(run, scene)
    return float(np.abs(residual).max()) / put_in if put_in > 0.0 else float("nan")


def energy_put_in(run: xr.DataTree | xr.Dataset, scene: Scene) -> float:
    """Return the initial energy plus the largest work of gravity and of loads [J/m]."""
    series = _series(run)
    start = float(series["total_energy"].isel(time=0).sum())
    return start + sum(max(0.0, float(series[name].max())) for name in _works(scene) if name in series)


def dissipation(run: xr.DataTree | xr.Dataset, scene: Scene) -> float:
    """Return the fraction of the energy put in that is lost, apart from friction and material dissipation.

    Transfer, integration of strain, impulses and dashpots lose it; a negative value is a gain. NaN if the run
    did not end, or has gravity, loads or moving sides but no energy ledger.
    """
    series, works = _series(run), _works(scene)
    if "total_energy" not in series or (scene.gravity and not _has(series, "gravity_work")):
        return float("nan")
    if "external_work" in works and not _has(series, "external_work"):
        return float("nan")
    terms = [series[name].sum("body", skipna=False) for name in _BY_BODY if _has(series, name)]
    terms += [series[name].sum("pair") for name in _BY_PAIR if _has(series, name)]
    terms += [-series[name] for name in works if _has(series, name)]
    lost = sum(float(term.isel(time=0) - term.isel(time=-1)) for term in terms)
    put_in = energy_put_in(series, scene)
    return lost / put_in if put_in > 0.0 else float("nan")


def _series(run: xr.DataTree | xr.Dataset) -> xr.Dataset:
    return run if isinstance(run, xr.Dataset) else run["series"].to_dataset()


def _has(series: xr.Dataset, name: str) -> bool:
    """Return True if this run has the series; other runs of its dataset may have it alone."""
    return name in series and bool(series[name].notnull().any())


def _works(scene: Scene) -> list[str]:
    sides = [side for body in scene.bodies.values() for side in body.sides]
    driven = any(body.prescribed for body in scene.bodies.values())
    loaded = bool(scene.loads) or driven or any(side.fixed is None for side in sides)
    return ["gravity_work"] + ["external_work"] * loaded


def momentum_change(run: xr.DataTree, scene: Scene) -> float:
    """Return the largest change of total momentum of free bodies, over the sum of their initial ones."""
    held = any(body.sides or body.prescribed for body in scene.bodies.values())
    if scene.gravity or scene.loads or held:
        return float("nan")
    series = run["series"]["linear_momentum"]
    whole, brought = series.sum("body"), float(np.abs(series.isel(time=0)).sum())
    return float(np.abs(whole - whole.isel(time=0)).max()) / brought if brought > 0.0 else float("nan")
