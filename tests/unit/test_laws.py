"""Laws of contact: traction and bounded strain (Bardenhagen et al., 2001), hybrid, springs, adhesion."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad

from contact_scenes import CELL, impact, rectangle, scene
from mpmfw.contact.rows import ContactRows
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw_contact.adhesion import energy_of, normal_force, reach_of
from mpmfw_contact.hybrid import HybridContact
from mpmfw_contact.penalty import Penalty, PenaltyLaw
from mpmfw_contact.points import PointSpheres

DT = 1e-4


def parting(pressure: float, speed: float = 0.2, **options) -> Simulation:
    """Two blocks that touch and separate, under a ``pressure`` of all their points, after one step."""
    scene = impact(gap=0.0, speed=-speed, slide=0.0, friction=0.0)
    scene["contact"]["bardenhagen"] = options
    for body in scene["bodies"].values():
        body["rotation"] = "lumped"  # the correction of inertia comes after that of contact
    simulation = Simulation(scene, contact="bardenhagen")
    simulation.start()
    simulation.state.particles.stress[:] = -pressure * np.eye(2)
    simulation.step(DT)
    return simulation


def on_first(simulation: Simulation) -> float:
    """Impulse on the first body along the outward normal of the second, −x [N s/m]."""
    return -float(simulation.contact.records.impulse[0, 0])


def test_separating_bodies_under_compression_are_held_together():
    free, held = parting(10.0), parting(10.0, traction=True)
    assert on_first(free) == 0.0
    rows = held.contact.rows
    assert rows.own.compressed[: rows.count].all()
    assert on_first(held) < 0.0
    velocity = np.zeros((len(rows.pair), 2))
    rows.momentary_velocity(held.state.grid, velocity)
    across = (velocity * rows.normal).sum(axis=1)[: rows.count]
    np.testing.assert_allclose(across, 0.0, atol=1e-12)


@pytest.mark.parametrize("pressure", [0.0, -10.0])
def test_bodies_without_compression_separate_freely(pressure):
    assert on_first(parting(pressure, traction=True)) == 0.0


def test_approaching_bodies_are_in_contact_whatever_the_stress():
    together, bound = (parting(-10.0, speed=-0.2, traction=on) for on in (False, True))
    assert on_first(together) > 0.0
    np.testing.assert_array_equal(bound.contact.records.impulse, together.contact.records.impulse)


def test_the_traction_is_that_across_the_normal():
    """A stress along the face alone, of whichever sign, does not hold bodies together."""
    scene = impact(gap=0.0, speed=-0.2, slide=0.0, friction=0.0)
    scene["contact"]["bardenhagen"] = {"traction": True, "normal": "specified", "direction": [1.0, 0.0]}
    simulation = Simulation(scene, contact="bardenhagen")
    simulation.start()
    simulation.state.particles.stress[:] = np.diag([0.0, -10.0])
    simulation.step(DT)
    assert simulation.contact.rows.count > 0
    assert on_first(simulation) == 0.0


def test_impulses_strain_the_lighter_body_by_no_more_than_the_bound():
    strain = 1e-6
    simulation = parting(0.0, speed=-1.0, largest_strain=strain)
    rows, mass = simulation.contact.rows, simulation.state.grid.mass
    lighter = mass[rows.dof[: 2 * rows.count].reshape(-1, 2)].min(axis=1)
    of_updated = rows.force[: rows.count] - simulation.contact.of_projected  # each correction is bounded
    normal = (of_updated * rows.normal[: rows.count]).sum(axis=1)
    assert (normal * DT / (lighter * CELL)).max() == pytest.approx(strain)
    assert 0.0 < on_first(simulation) < on_first(parting(0.0, speed=-1.0))


MODULUS, AREA, MASSES = 50.0, 0.2, (2.0, 3.0)
TOGETHER = MASSES[0] * MASSES[1] / sum(MASSES)


def impulse(
    *,
    gap: float,
    approach: float,
    dt: float,
    slip: float = 0.0,
    friction: float = 0.0,
    moves: bool = True,
    work: np.ndarray | None = None,
    projected: bool = False,
) -> np.ndarray:
    """On the first of two nodes that approach along x by ``approach`` [m/s] and slip along y."""
    law = HybridContact()
    law.modulus, law.strain_first, law.dt = np.array([MODULUS]), False, dt
    rows = ContactRows(2, couples=False, own=law.row_arrays(friction=True))
    rows.allocate_friction(cohesion=False)
    rows.count = 1
    rows.start[:2], rows.dof[:2], rows.weight[:2] = [0, 2], [0, 1], [1.0, -1.0]
    rows.normal[0], rows.gap[0], rows.area[0], rows.friction[0] = [-1.0, 0.0], gap, AREA, friction
    grid = SimpleNamespace(
        mass=np.array(MASSES),
        momentum=np.array([[MASSES[0] * approach, MASSES[0] * slip], [0.0, 0.0]]),
        spacing=(1.0, 1.0),
    )
    law.impulses(rows, grid, (np.zeros(1) if work is None else work) if moves else None, projected=projected)
    return rows.force[0].copy()


@pytest.mark.parametrize("dt", [1e-3, 1e-2, 1.0])
@pytest.mark.parametrize("gap", [-1e-3, -0.1])
def test_the_impulse_is_the_lesser_of_spring_and_approach(gap: float, dt: float) -> None:
    expected = min(MODULUS * AREA * -gap * dt, TOGETHER * 0.5)
    np.testing.assert_allclose(impulse(gap=gap, approach=0.5, dt=dt), [-expected, 0.0], rtol=1e-13)


@pytest.mark.parametrize("projected", [False, True])
def test_friction_works_on_the_slip_of_the_end_or_on_the_mean(projected: bool) -> None:
    """The mean is that of a momentum that was projected once more."""
    work, common = np.zeros(1), {"gap": -0.1, "approach": 0.5, "dt": 1.0, "slip": 2.0, "friction": 0.3}
    tangential = abs(impulse(**common, work=work, projected=projected)[1])
    after = 2.0 - tangential / TOGETHER
    assert 0.0 < after < 1.9
    assert work == pytest.approx(tangential * (0.5 * (2.0 + after) if projected else after), rel=1e-12)


def test_bodies_that_only_touch_exchange_nothing() -> None:
    np.testing.assert_array_equal(impulse(gap=0.0, approach=0.5, dt=1.0), 0.0)


@pytest.mark.parametrize("dt", [1e-3, 1.0])
def test_bodies_that_overlap_and_separate_are_pushed(dt: float) -> None:
    expected = min(MODULUS * AREA * 0.1 * dt, TOGETHER * 0.5)
    np.testing.assert_allclose(impulse(gap=-0.1, approach=-0.5, dt=dt), [-expected, 0.0], rtol=1e-13)


def test_the_momentum_of_the_strain_is_only_stopped() -> None:
    """MUSL's second momentum moves no point, and has been pushed already."""
    np.testing.assert_array_equal(impulse(gap=-0.1, approach=-0.5, dt=1.0, moves=False), 0.0)
    assert impulse(gap=-0.1, approach=0.5, dt=1.0, moves=False)[0] < 0.0


def test_friction_is_within_the_cone_of_the_bounded_impulse() -> None:
    bounded = MODULUS * AREA * 0.01 * 0.1
    found = impulse(gap=-0.01, approach=0.5, dt=0.1, slip=2.0, friction=0.3)
    np.testing.assert_allclose(found, [-bounded, -0.3 * bounded], rtol=1e-13)


K, PULL = 50.0, 2.0  # the spring comes to the pull at 0.04
WIDTH, TRACTION = 0.4, 500.0


@pytest.mark.parametrize(("separation", "reach"), [(0.0, 0.04), (0.03, 0.04), (0.1, 0.1)])
def test_the_energy_is_the_work_of_the_force(separation, reach):
    assert reach_of(K, PULL, separation) == pytest.approx(reach)
    for gap in (-0.02, 0.0, 0.02, 0.05, 0.2):
        breaks = [x for x in (0.0, 0.04, reach) if x > gap]
        work, _ = quad(lambda g: normal_force(K, g, PULL, separation), gap, 1.0, points=breaks, limit=200)
        assert energy_of(K, gap, PULL, separation) == pytest.approx(work, abs=1e-9)
    assert normal_force(K, 0.03, PULL, separation) == pytest.approx(-1.5)
    assert normal_force(K, reach - 1e-6, PULL, separation) == pytest.approx(-PULL, abs=1e-4)
    assert normal_force(K, reach, PULL, separation) == 0.0


def test_the_work_of_adhesion_is_traction_times_separation():
    """But for what the spring takes up to the traction, half of σ_0 g_0."""
    assert energy_of(K, 0.0, PULL, 0.1) == pytest.approx(-PULL * (0.1 - 0.5 * 0.04))


#: The share that a detection may be off: of nodes, those of the ground at the punch's edges bear by whole
#: tributary lengths.
OFF = {"surfaces": 0.04, "midplane": 0.01}


@pytest.mark.parametrize("contact", OFF)
def test_a_flat_punch_is_pulled_off_by_traction_times_area(contact):
    """The upper block is drawn up by its top; the force comes to σ_0 A, and then there is none."""
    blocks = {
        "punch": rectangle(
            [-0.5 * WIDTH, 0.0],
            [0.5 * WIDTH, 0.3],
            velocity=[0.0, 0.0],
            sides=[{"side": "top", "velocity": [0.0, 0.02]}],
        ),
        "ground": rectangle(
            [-0.4, -0.3], [0.4, 0.0], velocity=[0.0, 0.0], sides=[{"side": "bottom", "fixed": True}]
        ),
    }
    mapping = scene(blocks, friction=0.0, output={"particles": False, "gap": False})
    options = {"traction": TRACTION, "separation": 0.003}
    mapping["contact"] = {"detection": contact, "law": "adhesion", "adhesion": options}
    simulation = Simulation(load_scene(mapping))
    simulation.start()
    records, pull, times = simulation.contact.records, [], []
    before = 0.0
    while simulation.state.time < 0.4:
        simulation.step()
        impulse = float(records.impulse[0, 1])
        pull.append((impulse - before) / simulation.state.dt)
        times.append(simulation.state.time)
        before = impulse
    pull = -np.array(pull)
    assert pull.max() == pytest.approx(TRACTION * WIDTH, rel=OFF[contact])
    assert not pull[-20:].any()
    # the force rises in no jump: at half of the way there is some of it
    assert 0.2 < pull[np.searchsorted(times, 0.5 * times[int(pull.argmax())])] / pull.max() < 0.8


def test_a_separation_without_traction_is_refused():
    contact = {"method": "adhesion", "adhesion": {"separation": 0.1}}
    with pytest.raises(SceneError, match="'separation' has no effect without tension"):
        load_scene(impact() | {"contact": contact})


def test_a_contact_of_another_detection_is_made_of_the_law_alone():
    class AtPoints(Penalty):
        Detection = PointSpheres

    assert AtPoints.Options.model_fields.keys() == (
        PenaltyLaw.Options.model_fields.keys() | PointSpheres.Options.model_fields.keys()
    )
    assert "search_radius" in Penalty.Options.model_fields
    assert "search_radius" not in AtPoints.Options.model_fields
