"""Hard scenes of other fields: penetration, energy, momentum and stopping distances, for several contacts."""

# cost: 260

from __future__ import annotations

import tomllib
from typing import TYPE_CHECKING, Any

import numpy as np
from hard_scenes_figure import matrix

from mpmfw.scene import load_scene
from mpmfw.validation import Case, Method

if TYPE_CHECKING:
    import xarray as xr

    from mpmfw.scene import Scene

CONTACTS = ("penalty", "bardenhagen", "bardenhagen(criterion=position, normal=master)", "surfaces+impulse")
QUICK = ("cliff-edges", "internal-edges", "stopping-0.5")
#: Residual of the ledger over the energy put in [%], momentum over what the bodies bring, stopping distance [%].
ENERGY, MOMENTUM, STOP = 0.5, 1e-10, 0.5


def check(case: Case) -> None:
    """Run every scene with every contact."""
    criteria = tomllib.loads((case.folder / "criteria.toml").read_text(encoding="utf-8"))
    gaps: dict[tuple[str, str], float] = {}
    for name in QUICK if case.quick else criteria:
        limits, file = criteria[name], f"scenes/{name}.toml"
        scene = load_scene(case.folder / file)
        methods = case.methods(CONTACTS[:1] if case.quick else CONTACTS, ("cpdi",))
        for method, tree in case.runs(methods, file):
            series = tree["series"].to_dataset()
            judge = Judge(case, name, method, limits.get("open", {}))
            gaps[name, method.contact] = float(series["min_gap"].min()) / scene.grid.cell_size
            judge(
                "penetration",
                "deepest penetration",
                max(0.0, -gaps[name, method.contact]),
                limits["penetration"],
                "cells",
            )
            judge("energy", "energy residual", 100.0 * residual(series), ENERGY, "%")
            if limits.get("momentum"):
                judge("momentum", "momentum made", momentum_made(series), MOMENTUM)
            if "stops" in limits:
                off = 100.0 * (distance(series, scene) / limits["stops"] - 1.0)
                judge("stops", "stopping distance, error", off, STOP, "%", least=-STOP)
    case.figure("", matrix(gaps, {name: criteria[name]["penetration"] for name in criteria}))


class Judge:
    """Holds a number against its limit: a gate, unless it is listed as open or the method is not the recommended one."""

    def __init__(self, case: Case, scene: str, method: Method, left: dict[str, str]) -> None:
        self.case, self.scene, self.method, self.left = case, scene, method, left

    def __call__(
        self, key: str, what: str, value: float, most: float, unit: str = "1", least: float = 0.0
    ) -> None:
        quantity = f"{self.scene}: {what}"
        if key in self.left:
            self.case.show(quantity, value, unit=unit, method=self.method, reference=most)
        else:
            self.case.judge(self.method, quantity, value, within=(least, most), unit=unit)


def residual(series: xr.Dataset) -> float:
    """Largest residual of the ledger over the energy put in: that of the start and the largest work of gravity."""
    start = float(series["total_energy"].isel(time=0).sum())
    given = float(series["gravity_work"].max()) if "gravity_work" in series else 0.0
    return float(np.abs(series["energy_residual"]).max()) / (start + max(given, 0.0))


def momentum_made(series: xr.Dataset) -> float:
    """Largest change of the whole momentum, over the sum of what the bodies bring."""
    momentum = series["linear_momentum"]
    whole = momentum.sum("body")
    brought = float(np.abs(momentum.isel(time=0)).sum())
    return float(np.abs(whole - whole.isel(time=0)).max()) / brought


def distance(series: xr.Dataset, scene: Scene) -> float:
    """Way of the block to the end of the run, by which it has stopped [m]."""
    body = next(name for name, one in scene.bodies.items() if one.velocity is not None)
    along: Any = series["centre_of_mass"].sel(body=body, axis="x").values
    return float(along[-1] - along[0])
