"""What a run keeps of energy and momentum, relative to what there is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.scene import Scene

#: Series whose sum is the error in time of strain and contact: the ledger's residuals beside the work of the half step by
#: which velocities are behind positions, which the transfer loses as it loses kinetic energy.
_RESIDUALS = (
    (1.0, "energy_residual"),
    (-1.0, "half_step_work"),
    (1.0, "contact_residual"),
    (-1.0, "contact_half_step_work"),
)


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


def energy_put_in(run: xr.DataTree, scene: Scene) -> float:
    """Energy of the start, and the largest works of gravity, loads and sides that move [J/m]."""
    series = run["series"].to_dataset()
    sides = [side for body in scene.bodies.values() for side in body.sides]
    loaded = bool(scene.loads) or any(side.fixed is None for side in sides)
    works = ["gravity_work"] + ["external_work"] * loaded
    start = float(series["total_energy"].isel(time=0).sum())
    return start + sum(max(0.0, float(series[name].max())) for name in works if name in series)


def momentum_change(run: xr.DataTree, scene: Scene) -> float:
    """Largest change of the whole momentum, over the sum of what the bodies bring; NaN where something acts on them."""
    if scene.gravity or scene.loads or any(body.sides for body in scene.bodies.values()):
        return float("nan")
    series = run["series"]["linear_momentum"]
    whole, brought = series.sum("body"), float(np.abs(series.isel(time=0)).sum())
    return float(np.abs(whole - whole.isel(time=0)).max()) / brought if brought > 0.0 else float("nan")
