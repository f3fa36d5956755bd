"""Damping of materials: modes decay as in closed form, the ledger has what is lost, rotation loses none."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mpmfw
from mpmfw.api import SceneError
from mpmfw.effects.damping import add_viscous_stress
from mpmfw.results.conservation import dissipation
from mpmfw.runs.simulation import Simulation
from mpmfw_testing.bench import points_at_rest
from scenes_for_tests import block, scene_of, solid, two_blocks, with_changes

BULK, SHEAR = 1.0, 0.75


def bar(wave: str, dim: int = 2, **changes: Any) -> dict[str, Any]:
    """A bar of 1 m, held at its left end, whose sides leave it one motion: u_x(x), or u_y(x)."""
    lower, upper = [0.0] * dim, [1.0, 0.25, 0.25][:dim]
    sides: list[dict[str, Any]] = [{"side": "left", "fixed": True}]
    for axis, names in (("y", ("bottom", "top")), ("z", ("back", "front")))[: dim - 1]:
        fixed = [axis] if wave == "pressure" else ["x", "z"][: dim - 1]
        sides += [{"side": name, "fixed": fixed} for name in names]
    elastic = {"model": "linear_elastic", "density": 1.0, "bulk_modulus": BULK, "shear_modulus": SHEAR}
    body = solid(lower, upper, "0.5 cells", "solid", sides=sides)
    corners = [-0.5] * dim, [1.5, 0.75, 0.75][:dim]
    tables = {"materials": {"solid": elastic}, "output": {"ledger": True}}
    return with_changes(scene_of({"bar": body}, 0.125, *corners, end=99.0, **tables), **changes)


def decay(scene: dict[str, Any], wave: str) -> tuple[float, dict[str, float]]:
    """Share of the first mode's velocity that is left after a period, and energies over that at first."""
    modulus, axis = (BULK + 4.0 / 3.0 * SHEAR, 0) if wave == "pressure" else (SHEAR, 1)
    period = 4.0 / math.sqrt(modulus)
    simulation = Simulation(scene)
    simulation.start()
    p = simulation.state.particles
    mode = np.sin(0.5 * np.pi * p.position[:, 0])
    p.velocity[:, axis] = 1e-4 * mode
    first = simulation._recorder.frame(0.0).series
    while simulation.state.time < period * (1.0 - 1e-9):
        simulation.step_towards(period)
    last = simulation._recorder.frame(period).series
    energy = float(first["kinetic_energy"].sum())
    left = float(p.mass @ (p.velocity[:, axis] * mode) / (p.mass @ mode**2)) / 1e-4
    return left, {name: float(np.sum(last[name])) / energy for name in last if "axis" not in name}


@cache
def undamped(wave: str, dim: int) -> float:
    """Share of the velocity that is left without damping."""
    return decay(bar(wave, dim), wave)[0]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("wave", ["pressure", "shear"])
@pytest.mark.parametrize(
    "damping",
    [{"bulk": 0.1}, {"shear": 0.1}, {"critical": 0.05, "frequency": 0.25}],
    ids=["bulk", "shear", "critical"],
)
def test_the_first_mode_of_a_bar_decays_as_in_closed_form(
    wave: str, dim: int, damping: dict[str, float]
) -> None:
    """exp(−ξ ω T) after a period T = 2π/ω, with ξ = τ ω/2; damping of the volume leaves shear alone."""
    bulk, shear = damping.get("bulk", 0.0), damping.get("shear", 0.0)
    if "critical" in damping:
        bulk = shear = damping["critical"] / (math.pi * damping["frequency"])
    modulus, viscosity = SHEAR, shear * SHEAR
    if wave == "pressure":
        modulus, viscosity = BULK + 4.0 / 3.0 * SHEAR, bulk * BULK + 4.0 / 3.0 * shear * SHEAR
    ratio = 0.25 * math.pi * viscosity / math.sqrt(modulus)  # ω = (π/2) √(modulus)
    plain = undamped(wave, dim)
    left, energies = decay(bar(wave, dim, materials__solid__damping=damping), wave)
    damped = math.sqrt(1.0 - ratio**2)  # the period is longer by this
    phase = 2.0 * math.pi * damped
    expected = math.exp(-2.0 * math.pi * ratio) * (math.cos(phase) - ratio / damped * math.sin(phase))
    assert plain == pytest.approx(1.0, abs=0.005)
    assert left == pytest.approx(expected, abs=0.005)
    assert abs(energies["energy_residual"]) < 0.02
    kept = energies["kinetic_energy"] + energies["strain_energy"] + energies["viscous_dissipation"]
    assert kept == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize(
    ("shape", "scheme"),
    [
        *((shape, "usl") for shape in ("gimp", "cpdi2")),
        *(("bspline", scheme) for scheme in ("musl", "usf")),
    ],
)
def test_every_shape_and_scheme_damps(shape: str, scheme: str) -> None:
    damping = {"critical": 0.05, "frequency": 0.25 * math.sqrt(SHEAR)}
    lower = -0.54 if shape == "gimp" else -0.5  # on grid lines GIMP has edges of little mass that do not hold
    scene = bar("shear", shape__method=shape, stepping__scheme=scheme, grid__lower=[lower, lower])
    plain, _ = decay(scene, "shear")
    left, _ = decay(with_changes(scene, materials__solid__damping=damping), "shear")
    assert left / plain == pytest.approx(math.exp(-0.1 * math.pi), abs=0.02)


@settings(max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), dim=st.sampled_from([2, 3]))
def test_damping_is_objective_and_never_gives_energy(seed: int, dim: int) -> None:
    """The stress turns with the motion, has none of a spin, and its power is not negative."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(dim, dim)))[0]
    gradient, spin = rng.normal(size=(2, dim, dim))
    spin -= spin.T
    bulk, shear = rng.choice([0.0, 1.0], 2) * rng.lognormal(size=2)
    points = points_at_rest(np.zeros((3, dim)), np.ones(3), [0, 3])
    points.velocity_gradient[:] = gradient, turn @ gradient @ turn.T + spin, spin
    points.deformation_gradient *= 1.2
    work = np.zeros(3)
    add_viscous_stress(0, 3, points, float(bulk), float(shear), 0.5, work, (1.0,) * dim)
    stress = points.stress
    scale = 1.0 + np.abs(stress).max()
    assert np.allclose(stress[1], turn @ stress[0] @ turn.T, atol=1e-12 * scale)
    assert np.abs(stress[2]).max() < 1e-12 * scale
    power = 1.2**dim * np.einsum("ij,ij", stress[0], gradient)
    assert np.allclose(work[:2], 0.5 * power, atol=1e-12 * scale)
    assert work[0] >= -1e-12 * scale


def test_the_step_is_shorter_and_stable_at_its_limit() -> None:
    """2/ω (√(1 + ξ²) − ξ), with ξ = τ c/h of the fastest wave that CPDI has: c/h over its Courant number."""
    plain = Simulation(bar("pressure"))
    damped = Simulation(bar("pressure", materials__solid__damping={"bulk": 0.2, "shear": 0.2}))
    ratio = 0.2 * math.sqrt(BULK + 4.0 / 3.0 * SHEAR) / 0.125 / 0.8
    (limit, owner), (before, _) = damped.limits()[0], plain.limits()[0]
    assert limit == pytest.approx(before * (math.sqrt(1.0 + ratio**2) - ratio))
    assert owner == "bulk wave speed (h / c), with damping"
    left, _ = decay(bar("pressure", materials__solid__damping={"bulk": 0.2}, time__safety=0.8), "pressure")
    assert abs(left) < 1.0


def test_damped_bodies_in_contact_lose_it_to_damping() -> None:
    scene = two_blocks(
        "penalty", materials__soft__damping={"bulk": 1e-4, "shear": 1e-4}, output={"ledger": True}
    )
    series = mpmfw.run(scene)["series"].to_dataset()
    lost = series["viscous_dissipation"].sum("body").values
    assert lost[-1] > 0.01 * float(series["kinetic_energy"].isel(time=0).sum())
    assert (np.diff(lost) >= 0.0).all()
    assert abs(dissipation(series, mpmfw.load_scene(scene))) < 0.1


@pytest.mark.parametrize(
    "damping", [{}, {"bulk": 0.0}, {"critical": 0.1}, {"bulk": 1.0, "critical": 0.1, "frequency": 1.0}]
)
def test_half_a_damping_and_none_are_refused(damping: dict[str, float]) -> None:
    with pytest.raises(SceneError, match="bulk, shear or both, or critical and frequency"):
        mpmfw.load_scene(block(materials__soft__damping=damping))
