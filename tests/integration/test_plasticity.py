"""Materials with a history in a run: their energy is in the ledger, and contact does not know of them."""

from contextlib import nullcontext

import numpy as np
import pytest

import mpmfw
from mpmfw.errors import ResultsWarning, SimulationError
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import body_of, scene_of, solid

SOFT = {
    "model": "j2",
    "density": 1000.0,
    "youngs_modulus": "10 MPa",
    "poissons_ratio": 0.3,
    "yield_stress": "0.1 MPa",
}


def bar(dim=2):
    """A bar that is held at its foot and comes down at a tenth of its wave speed (Taylor's test)."""
    lower, upper = [-0.4, 0.0, -0.4][:dim], [0.4, 1.6, 0.4][:dim]
    sides = [{"side": "bottom", "fixed": ["y"]}]
    made = solid(lower, upper, 0.1, velocity=[0.0, -10.0, 0.0][:dim], sides=sides)
    corners = [-1.6, -0.4, -1.6][:dim], [1.6, 2.0, 1.6][:dim]
    return scene_of(
        {"bar": made}, 0.2, *corners, end=0.08, outputs=10, materials={"soft": SOFT}, output={"ledger": True}
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_what_is_dissipated_is_in_the_ledger(dim):
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


def copper(density, young, poisson, strength, hardening):
    """Copper of some density, moduli [Pa], yield stress [Pa] and hardening [Pa]."""
    elastic = {"density": density, "youngs_modulus": young, "poissons_ratio": poisson}
    return {"model": "j2", **elastic, "yield_stress": strength, "hardening_modulus": hardening}


#: A copper disc of ten cells on a free copper block, at 500 m/s, until the jets at the rim are drawn out.
SPRAY = scene_of(
    {
        "ball": body_of(
            *({"type": "disc", "centre": [0, 8.2e-6], "radius": 8e-6}, "0.5 cells", "copper"),
            velocity=[0, -500],
        ),
        "block": solid([-18e-6, -12e-6], [18e-6, 0], "0.5 cells", "copper"),
    },
    *(1e-6, [-26e-6, -24e-6], [26e-6, 24e-6]),
    end=14e-9,
    outputs=14,
    contact={"method": "penalty", "friction": 0.2},
    materials={"copper": copper(8960, 124e9, 0.34, 120e6, 300e6)},
    output={"ledger": True, "gap": False},
)


@pytest.mark.parametrize(
    ("contact", "shape"),
    [("penalty", "cpdi"), ("penalty", "cpdi2"), ("lcp", "cpdi"), ("bardenhagen(normal=master)", "cpdi")],
)
def test_plastic_flow_keeps_momentum_and_makes_no_energy(contact, shape):
    """CPDI domains under large plastic flow; surfaces of contact at nodes are 0.2 to 0.5 cells deep."""
    on_grid = contact.startswith("bardenhagen")
    with pytest.warns(ResultsWarning, match=r"ball-block: .*penetrat") if on_grid else nullcontext():
        series = mpmfw.run(SPRAY, contact=contact, shape=shape)["series"].to_dataset()
    momentum = series["linear_momentum"].sum("body").values
    assert np.abs(momentum - momentum[0]).max() < 1e-10 * np.abs(momentum[0]).max()
    energy = series["kinetic_energy"] + series["strain_energy"] + series["affine_energy"]
    total = (energy + series["material_dissipation"]).sum("body").values
    assert 0.85 * total[0] < total[-1] < 1.001 * total[0]
    assert total.max() < 1.001 * total[0]


@pytest.mark.parametrize(
    ("shape", "scheme", "contact", "recommended", "running"),
    [
        ("cpdi", "usl", "penalty", ["contact.penalty.kappa", "another shape than 'cpdi'"], ["scheme"]),
        ("gimp", "musl", "bardenhagen", ["scheme 'usl'", "another contact"], ["softer"]),
        ("linear", "musl", None, ["time.safety"], ["scheme", "contact"]),
    ],
)
def test_advice_names_nothing_that_runs_already(shape, scheme, contact, recommended, running):
    bodies = SPRAY["bodies"] if contact else {"ball": SPRAY["bodies"]["ball"]}
    scene = {**SPRAY, "bodies": bodies, "stepping": {"scheme": scheme}, "output": {}}
    if contact is None:
        del scene["contact"]
    simulation = Simulation(scene, contact=contact, shape=shape)
    simulation.start()
    simulation.state.particles.deformation_gradient[0, 0, 0] = -1.0
    with pytest.raises(SimulationError, match="inverted") as failed:
        simulation.step()
    assert failed.value.advice is not None
    assert all(text in failed.value.advice for text in recommended)
    assert not any(text in failed.value.advice for text in running)
