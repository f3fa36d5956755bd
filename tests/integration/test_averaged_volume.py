"""Averaged change of volume: what its means keep, that bodies no longer lock, and that energy is kept."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mpmfw
from mpmfw.effects.averaged_volume import average_pressure, average_volume
from mpmfw.runs.simulation import Simulation
from mpmfw.state.windows import make_grid, set_windows
from mpmfw_testing.bench import points_at_rest
from scenes_for_tests import disc, scene_of, solid, two_blocks, with_changes

AVERAGED = {"bodies__solid__volumetric": "averaged"}
STIFF = {"model": "neo_hookean", "density": 1000.0, "youngs_modulus": 1e6, "poissons_ratio": 0.499}


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), dim=st.sampled_from([2, 3]), dt=st.sampled_from([1e-7, 0.02]))
def test_means_keep_volume_and_work_and_leave_a_common_motion(seed: int, dim: int, dt: float) -> None:
    """Σ V j, by ROOT_STEPS also where j changes by 20 %, and Σ V p̄ tr L = Σ V p tr L̄ for small steps; a rigid
    turn and a swelling stay."""
    rng, n = np.random.default_rng(seed), 20
    spacing = (0.5,) * dim
    grid = make_grid(0.5, np.zeros(dim), np.full(dim, 2.0), 1)
    set_windows(grid, np.zeros((1, dim), np.int64), grid.nodes[None].copy(), 10**6)
    points = points_at_rest(rng.uniform(0.0, 2.0, (n, dim)), rng.lognormal(size=n), [0, n])
    before = points.velocity_gradient[:] = rng.normal(size=(n, dim, dim))
    points.stress[:] = rng.normal(size=(n, dim, dim))
    pressure, volume = np.trace(points.stress, axis1=1, axis2=2) / dim, points.volume
    rate = np.trace(before, axis1=1, axis2=2)
    cell, first, second = np.zeros(n, np.int64), np.zeros(len(grid.mass)), np.zeros(len(grid.mass))
    of_points = np.zeros(n)
    change = np.linalg.det(np.eye(dim) + dt * before)
    average_volume(0, n, points, points.volume, grid, 0, dt, cell, of_points, first, second, spacing, spacing)
    after = points.velocity_gradient
    averaged = np.linalg.det(np.eye(dim) + dt * after)
    assert volume @ averaged == pytest.approx(volume @ change, rel=1e-12)
    for c in set(cell.tolist()):
        assert np.ptp(averaged[cell == c]) < 1e-13
    points.volume *= averaged
    excess = np.zeros(n)
    average_pressure(0, n, points, points.volume, 0, len(first), cell, second, first, spacing, excess, 0.5)
    assert np.bincount(cell, points.volume * excess) == pytest.approx(0.0, abs=1e-9)
    mean = np.trace(points.stress, axis1=1, axis2=2) / dim
    work = volume @ (pressure * np.trace(after, axis1=1, axis2=2))
    assert volume @ (mean * rate) == pytest.approx(work, abs=max(1e-5, 10.0 * dt) * n * np.abs(volume).max())
    common = rng.normal(size=(dim, dim))
    points.velocity_gradient[:] = common
    average_volume(0, n, points, points.volume, grid, 0, dt, cell, of_points, first, second, spacing, spacing)
    assert np.allclose(points.velocity_gradient, common, atol=1e-8)
    points.velocity_gradient[0] = np.diag([-2.0 / dt, *[0.0] * (dim - 1)])  # turns inside out
    average_volume(0, n, points, points.volume, grid, 0, dt, cell, of_points, first, second, spacing, spacing)
    assert np.isnan(points.velocity_gradient[0]).all()


METAL = {**STIFF, "model": "j2", "poissons_ratio": 0.3, "yield_stress": 1e3}


@pytest.mark.parametrize(
    ("material", "shape", "how", "averaged"),
    [
        ({**STIFF, "poissons_ratio": 0.399}, "cpdi", "auto", False),
        ({**STIFF, "poissons_ratio": 0.401}, "cpdi", "auto", True),
        (STIFF, "bspline", "auto", False),
        (STIFF, "linear", "pointwise", False),
        (METAL, "gimp", "auto", True),
        (METAL, "cubic_bspline", "auto", False),
        (METAL, "cubic_bspline", "averaged", True),
    ],
)
def test_bodies_that_lock_are_averaged_by_default(
    material: dict[str, Any], shape: str, how: str, averaged: bool
) -> None:
    scene = disc(materials__soft=material, shape__method=shape, bodies__solid__volumetric=how)
    effects = {effect.name: effect.on for effect in Simulation(scene).effects}
    assert effects["averaged volume"] == averaged


@pytest.mark.parametrize("scheme", ["usl", "musl", "usf"])
def test_a_spinning_disc_keeps_its_spin_and_volume(scheme: str) -> None:
    scene = disc(
        materials__soft=STIFF, bodies__solid__angular_velocity=1.0, stepping__scheme=scheme,
        output={"particles": False}, **AVERAGED,
    )  # fmt: skip
    plain = with_changes(scene, bodies__solid__volumetric="pointwise")
    spins = [mpmfw.run(each)["series"]["angular_momentum"].values[-1, 0, 0] for each in (scene, plain)]
    assert spins[0] == pytest.approx(spins[1], rel=1e-3)


@pytest.mark.parametrize("method", ["none", "penalty"])
def test_bodies_at_one_node_are_averaged_apart(method: str) -> None:
    """One body of two has a mean: the other's points move as without it, until they feel each other."""
    scene = two_blocks(method, bodies__left__volumetric="averaged")
    simulation = Simulation(scene)
    simulation.start()
    p = simulation.state.particles
    left, right = (body.particles for body in simulation.state.bodies)
    p.velocity_gradient[:] = np.random.default_rng(1).normal(size=p.velocity_gradient.shape)
    before = p.velocity_gradient.copy()
    simulation.hook.after_velocity_gradient(particles=p, grid=simulation.state.grid, phi=None, dt=1e-4)
    assert np.array_equal(p.velocity_gradient[right], before[right])
    assert not np.array_equal(p.velocity_gradient[left], before[left])


@pytest.mark.parametrize("volumetric", ["auto", "averaged"])
def test_bodies_that_share_nodes_are_averaged_both(volumetric: str) -> None:
    """Without contact they stick; each has sums of its own points alone, whatever the other's."""
    how = {f"bodies__{name}__volumetric": volumetric for name in ("left", "right")}
    simulation = Simulation(two_blocks("none", materials__soft=STIFF, **how))
    simulation.start()
    p = simulation.state.particles
    p.stress[:] = np.random.default_rng(2).normal(size=p.stress.shape)
    total = [float(p.volume[body.particles] @ np.trace(p.stress[body.particles], axis1=1, axis2=2))
             for body in simulation.state.bodies]  # fmt: skip
    effect: Any = simulation.registry.plugins["averaged_volume"]
    p.velocity_gradient[:] = 0.0
    effect.after_velocity_gradient(particles=p, grid=simulation.state.grid, dt=1e-4)
    effect.update_stress(particles=p)
    for before, body in zip(total, simulation.state.bodies, strict=True):
        now = p.volume[body.particles] @ np.trace(p.stress[body.particles], axis1=1, axis2=2)
        assert now == pytest.approx(before, abs=1e-12)
    simulation = Simulation(two_blocks("none", materials__soft=STIFF, **how))
    simulation.advance(60)
    assert np.isfinite(simulation.state.particles.position).all()


@pytest.mark.parametrize("damping", [{}, {"damping": {"bulk": 0.05, "shear": 0.05}}], ids=["", "damped"])
def test_pressures_in_a_cell_stay_together_where_flow_dilates(damping: dict[str, Any]) -> None:
    """Sand between rough plates; else they differ by half of the mean pressure."""
    sand = {"model": "mohr_coulomb", "density": 2e3, "friction_angle": 0.6, "dilation_angle": 0.6}
    sand |= {"youngs_modulus": 1e7, "poissons_ratio": 0.3, **damping}
    sides = [{"side": "bottom", "fixed": True}, {"side": "top", "velocity": [0.0, -1.0]}]
    sides += [{"side": side, "pressure": 1e5} for side in ("left", "right")]
    begins = {"table": [[0.0, 1e5, 1e5], [2.0, 1e5, 1e5]], "top": 1.0}
    body = solid([0.0, 0.0], [1.0, 1.0], 0.125, sides=sides, initial_stress=begins)
    scene = scene_of({"solid": body}, 0.25, [-0.5, -0.5], [2.0, 2.0], end=0.3)
    simulation = Simulation({**scene, "materials": {"soft": sand}, "shape": {"method": "cpdi"}})
    while simulation.state.time < 0.15:
        simulation.advance(1)
    excess, stress = simulation.state.arrays["averaged_volume/excess"], simulation.state.particles.stress
    pressure = -np.trace(stress, axis1=1, axis2=2).mean() / 2.0
    assert 0.0 < np.abs(excess).max() * simulation.state.bodies[0].p_wave_modulus < 0.1 * pressure
