"""Relative errors of a run's energy and momentum."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from mpmfw.scene import Scene

#: Series whose sum is the error in time of strain and contact: the ledger's residuals beside the work of the
#: half step by which velocities are behind positions, which the transfer loses as it loses kinetic energy.
_RESIDUALS = (
    (1.0, "energy_residual"),
    (-1.0, "half_step_work"),
    (1.0, "contact_residual"),
    (-1.0, "contact_half_step_work"),
)

#: Series of energies and of their accounted losses.
_BY_BODY = ("kinetic_energy", "affine_energy", "strain_energy", "material_dissipation")
_BY_PAIR = ("contact_energy", "frictional_work")


def energy_error(run: xr.DataTree, scene: Scene) -> float:
    """Largest error in time of strain and contact over the energy put in; NaN without a ledger.

    A contact that does not tell what became of its work has an error of the strain alone.
    """
    series = run["series"].to_dataset()
    if "energy_residual" not in series:
        return float("nan")
    residual = sum(sign * series[name].values for sign, name in _RESIDUALS if name in series)
    put_in = energy_put_in(run, scene)
    return float(np.abs(residual).max()) / put_in if put_in > 0.0 else float("nan")


def energy_put_in(run: xr.DataTree | xr.Dataset, scene: Scene) -> float:
    """Energy of the start, and the largest works of gravity, loads and sides that move [J/m]."""
    series = _series(run)
    start = float(series["total_energy"].isel(time=0).sum())
    return start + sum(max(0.0, float(series[name].max())) for name in _works(scene) if name in series)


def dissipation(run: xr.DataTree | xr.Dataset, scene: Scene) -> float:
    """Share of the energy put in that a run ends without: neither kinetic, strain, friction nor plastic work.

    Kinetic energy is that of the points with their affine motion, strain energy also that of contact springs.
    What is left is what the transfer, the strain's integration, impulses and dashpots take; negative where a
    run gains energy. NaN where nothing is put in, of a run that did not end, and without a ledger in scenes
    with gravity, loads or sides that move.
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
    """Return whether the run has the series, not only other runs of a comparison."""
    return name in series and bool(series[name].notnull().any())


def _works(scene: Scene) -> list[str]:
    """Series of the works that something in the scene may do."""
    sides = [side for body in scene.bodies.values() for side in body.sides]
    loaded = bool(scene.loads) or any(side.fixed is None for side in sides)
    return ["gravity_work"] + ["external_work"] * loaded


def momentum_change(run: xr.DataTree, scene: Scene) -> float:
    """Largest change of the whole momentum, over the sum of what the bodies bring; NaN where something
    acts on them.
    """
    if scene.gravity or scene.loads or any(body.sides for body in scene.bodies.values()):
        return float("nan")
    series = run["series"]["linear_momentum"]
    whole, brought = series.sum("body"), float(np.abs(series.isel(time=0)).sum())
    return float(np.abs(whole - whole.isel(time=0)).max()) / brought if brought > 0.0 else float("nan")
