"""Materials with a history in a run: their energy is in the ledger, their state is saved, and contact does
not know of them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mpmfw
from mpmfw.runs.simulation import Simulation

SOFT = {
    "model": "j2",
    "density": 1000.0,
    "youngs_modulus": "10 MPa",
    "poissons_ratio": 0.3,
    "yield_stress": "0.1 MPa",
}


def bar(dim: int = 2, **material: Any) -> dict[str, Any]:
    """A bar that is held at its foot and comes down at a tenth of its wave speed (Taylor's test)."""
    lower, upper = [-0.4, 0.0, -0.4][:dim], [0.4, 1.6, 0.4][:dim]
    return {
        "grid": {"cell_size": 0.2, "lower": [-1.6, -0.4, -1.6][:dim], "upper": [1.6, 2.0, 1.6][:dim]},
        "time": {"end": 0.08, "output_interval": 0.008},
        "shape": {"method": "cpdi"},
        "materials": {"soft": {**SOFT, **material}},
        "bodies": {
            "bar": {
                "material": "soft",
                "geometry": {"type": "rectangle" if dim == 2 else "box", "lower": lower, "upper": upper},
                "particles": {"size": 0.1},
                "velocity": [0.0, -10.0, 0.0][:dim],
                "sides": [{"side": "bottom", "fixed": ["y"]}],
            }
        },
        "output": {"ledger": True},
    }


@pytest.mark.parametrize("dim", [2, 3])
def test_what_is_dissipated_is_in_the_ledger(dim: int) -> None:
    tree = mpmfw.run(bar(dim))
    series = tree["series"].to_dataset()
    start = float(series["kinetic_energy"].isel(time=0).sum())
    dissipated = series["material_dissipation"].isel(body=0)
    assert float(dissipated[-1]) > 0.5 * start
    assert bool((dissipated.diff("time") >= 0.0).all())
    assert float(np.abs(series["energy_residual"]).max()) < 0.03 * start
    strain = tree["particles/bar"]["plastic_strain"].isel(time=-1).values
    height = tree["particles/bar"]["position"].sel(axis="y").isel(time=0).values
    assert strain[height < 0.4].mean() > 3.0 * strain[height > 1.2].mean()


def test_a_run_goes_on_from_a_snapshot_with_its_history() -> None:
    simulation = Simulation(bar())
    simulation.advance(60)
    snapshot, found = simulation.snapshot(), []
    for _ in range(2):
        simulation.restore(snapshot)
        simulation.advance(60)
        found.append(
            (simulation.state.particles.stress.copy(), simulation.state.arrays["j2/plastic_strain"].copy())
        )
    for first, second in zip(*found, strict=True):
        np.testing.assert_array_equal(first, second)
    assert found[0][1].max() > 0.01


def test_two_materials_have_their_own_yield_stress() -> None:
    """A bar that yields on one that does not: the softer takes all of the plastic strain."""
    scene = bar()
    scene["materials"]["hard"] = {**SOFT, "yield_stress": "100 MPa"}
    scene["bodies"]["base"] = {
        "material": "hard",
        "geometry": {"type": "rectangle", "lower": [-1.0, -0.4], "upper": [1.0, 0.0]},
        "particles": {"size": 0.1},
        "sides": [{"side": "bottom", "fixed": True}],
    }
    scene["bodies"]["bar"].pop("sides")
    scene["grid"]["lower"] = [-1.6, -0.8]
    scene["contact"] = {"method": "penalty"}
    tree = mpmfw.run(scene)
    last = {
        name: tree[f"particles/{name}"]["plastic_strain"].isel(time=-1).values for name in ("bar", "base")
    }
    assert last["bar"].max() > 0.05
    assert last["base"].max() == 0.0
    up = float(tree["series"]["mean_velocity"].sel(body="bar", axis="y")[-1])
    assert abs(up) < 5.0  # an elastic one would come back at nearly 10 m/s
