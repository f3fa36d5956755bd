"""Loads that a scene names, total forces on sides, and the thickness of bodies of the plane, each against a
closed form.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel

import mpmfw
from mpmfw.api import BodyLoad, FloatArray, LoadedFacets, Particles, SurfaceLoad
from mpmfw.errors import PluginError, SceneError
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import BULK, DENSITY, SHEAR, SOFT, block, box, two_blocks

P_WAVE = BULK + 4.0 * SHEAR / 3.0
HOOKE = {**SOFT, "model": "linear_elastic"}
WALLS = [{"side": "left", "fixed": ["x"]}, {"side": "right", "fixed": ["x"]}]


def started(scene: dict[str, Any]) -> Simulation:
    sim = Simulation(scene)
    sim.start()
    return sim


def momentum(sim: Simulation) -> FloatArray:
    p = sim.state.particles
    return np.asarray(p.mass @ p.velocity)


@pytest.mark.parametrize("make", [block, box])
def test_a_point_force_gives_its_impulse(make: Any) -> None:
    force = [3.0, -2.0, 1.0][: 2 if make is block else 3]
    load = {"model": "point_force", "at": [0.2, 0.1, 0.0][: len(force)], "force": force}
    sim = started(make(loads={"push": load}, time__step=1e-4))
    sim.advance(20)
    np.testing.assert_allclose(momentum(sim), np.multiply(force, 20e-4), rtol=1e-9)


def test_a_point_force_in_time_gives_the_integral_of_its_table() -> None:
    rows = [[1e-3, 0.0, 0.0], [2e-3, 4.0, 2.0]]
    sim = started(
        block(loads={"push": {"model": "point_force", "at": [0, 0], "force": rows}}, time__step=1e-4)
    )
    sim.advance(40)
    # From the start of every step: 0 to 1 ms, the sum of 1 … 9 tenths to 2 ms, then 20 steps of the whole
    exact = np.array([4.0, 2.0]) * (0.1 * sum(range(10)) + 20) * 1e-4
    np.testing.assert_allclose(momentum(sim), exact, rtol=1e-9)


def test_a_body_force_goes_with_the_undeformed_volume() -> None:
    sim = started(block(loads={"field": {"model": "body_force", "force": [2.0, -7.0]}}, time__step=1e-4))
    sim.state.particles.volume *= 3.0
    sim.step(1e-4)
    np.testing.assert_allclose(momentum(sim), np.multiply([2.0, -7.0], 1e-4), rtol=1e-9)


@pytest.mark.parametrize("at", [[0.0, 0.0], [0.31, -0.17], [0.5, 0.5], [-0.5, 0.02]])
def test_a_point_force_has_its_moment(at: list[float]) -> None:
    """One step gives L = Δt x × F, at a corner and on a side as well: the force acts at the place that was
    asked for.
    """
    force = [3.0, -2.0]
    load = {"model": "point_force", "at": at, "force": force}
    sim = started(block(loads={"push": load}, time__step=1e-4, bodies__solid__rotation="lumped"))
    sim.step(1e-4)
    grid = sim.state.grid
    nodal = grid.mass[:, None] * (grid.velocity - grid.start_velocity)
    x = grid.position
    moment = float((x[:, 0] * nodal[:, 1] - x[:, 1] * nodal[:, 0]).sum())
    assert moment == pytest.approx(1e-4 * (at[0] * force[1] - at[1] * force[0]), abs=1e-12)


def test_a_body_force_of_rho_g_is_gravity() -> None:
    by_load = block(loads={"weight": {"model": "body_force", "force": [0.0, -10.0 * DENSITY]}})
    by_gravity = block(gravity={"vector": [0.0, -10.0]})
    found = []
    for scene in (by_load, by_gravity):
        sim = started(scene)
        sim.advance(10)
        found.append(sim.state.particles.velocity.copy())
    np.testing.assert_allclose(found[0], found[1], rtol=1e-10, atol=1e-12)


def test_drag_lets_the_velocity_decay_towards_the_medium() -> None:
    """v = u + (v_0 − u) exp(−c t), first order in Δt."""
    load = {"model": "drag", "rate": 20.0, "medium": [1.0, 0.0]}
    sim = started(block(loads={"air": load}, bodies__solid__velocity=[0.0, 2.0], time__step=1e-4))
    sim.advance(500)
    decay = math.exp(-20.0 * 0.05)
    expected = [1.0 - decay, 2.0 * decay]
    np.testing.assert_allclose(momentum(sim) / sim.state.particles.mass.sum(), expected, rtol=2 * 20.0 * 1e-4)


def test_drag_limits_the_step() -> None:
    sim = started(block(loads={"air": {"model": "drag", "rate": 1e6}}))
    assert (2e-6, "drag") in sim.limits()


def test_a_load_acts_on_the_bodies_that_it_names_alone() -> None:
    scene = two_blocks(
        "bardenhagen", loads={"field": {"model": "body_force", "bodies": ["left"], "force": [0, 9]}}
    )
    still = with_no_velocity(scene)
    sim = started(still)
    sim.advance(5)
    p = sim.state.particles
    left, right = (body.particles for body in sim.state.bodies)
    assert p.velocity[left, 1].min() > 0.0
    assert np.abs(p.velocity[right]).max() < 1e-9


def with_no_velocity(scene: dict[str, Any]) -> dict[str, Any]:
    for body in scene["bodies"].values():
        body.pop("velocity")
    return scene


@pytest.mark.parametrize(("shape", "size"), [("cpdi", 0.125), ("cpdi", 0.0625), ("gimp", 0.125)])
def test_a_total_force_on_a_side_does_not_depend_on_the_mesh(size: float, shape: str) -> None:
    """Half of the height, or another division into points: the sum is the force that was asked for."""
    sides = [{"side": "right", "force": [30.0, 5.0]}]
    for height in (0.5, 1.0):
        geometry = {"type": "rectangle", "lower": [-0.5, 0.0], "upper": [0.5, height]}
        changes = {"bodies__solid__geometry": geometry, "bodies__solid__particles__size": size}
        sim = started(block(bodies__solid__sides=sides, shape__method=shape, time__step=1e-4, **changes))
        sim.advance(20)
        np.testing.assert_allclose(momentum(sim), [30.0 * 20e-4, 5.0 * 20e-4], rtol=1e-9)


@pytest.mark.parametrize("key", ["traction", "force"])
def test_traction_and_force_on_a_side_in_space(key: str) -> None:
    """A side of 1 m²: the impulse of both is the same."""
    sides = [{"side": "top", key: [3.0, -2.0, 5.0]}]
    sim = started(box(bodies__solid__sides=sides, time__step=1e-5))
    sim.advance(5)
    np.testing.assert_allclose(momentum(sim), np.multiply([3.0, -2.0, 5.0], 5e-5), rtol=1e-6)


def test_a_total_force_keeps_its_sum_when_the_side_grows() -> None:
    """The top is drawn to twice its length; a traction's sum grows with it."""
    sim = started(block(bodies__solid__sides=[{"side": "top", "force": [0.0, 10.0]}]))
    surface = sim.state.surface
    assert surface is not None
    load = sim.manager.get_plugin("force on solid top")
    surface.position[:, 0] *= 2.0
    facets = LoadedFacets(sim.state, load.facets)
    assert facets.area.sum() == pytest.approx(2.0)
    np.testing.assert_allclose(facets.area @ load.traction(facets, 0.0), [0.0, 10.0], rtol=1e-12)


def test_a_plate_of_another_thickness_has_another_mass_and_the_same_stress() -> None:
    """Settled under the pressure on its top: the stress is the pressure, to the bit for powers of two."""
    found = {}
    for thickness in (None, 0.25):
        sides = [{"side": "bottom", "fixed": ["y"]}, *WALLS, {"side": "top", "pressure": 1e4}]
        scene = block(bodies__solid__sides=sides, materials__soft=HOOKE, settle={})
        if thickness is not None:
            scene["bodies"]["solid"]["thickness"] = thickness
        found[thickness] = started(scene).state.particles
    np.testing.assert_array_equal(found[0.25].mass, 0.25 * found[None].mass)
    np.testing.assert_array_equal(found[0.25].stress, found[None].stress)
    assert found[0.25].stress[:, 1, 1].mean() == pytest.approx(-1e4, rel=0.01)


def test_a_force_on_a_thinner_plate_stresses_it_more() -> None:
    """σ = F / (L t), settled; F in N."""
    for thickness in (0.5, 0.02):
        sides = [{"side": "bottom", "fixed": ["y"]}, *WALLS, {"side": "top", "force": [0.0, -100.0]}]
        scene = block(
            bodies__solid__sides=sides, bodies__solid__thickness=thickness, materials__soft=HOOKE, settle={}
        )
        stress = started(scene).state.particles.stress
        assert stress[:, 1, 1].mean() == pytest.approx(-100.0 / thickness, rel=0.01)


@pytest.mark.parametrize("contact", ["penalty", "adhesion", "barrier", "midplane", "hybrid", "nodes+penalty"])
def test_every_energy_goes_with_the_thickness(contact: str) -> None:
    """Of bodies of a quarter of a metre it is a quarter of that of one, to the bit: half steps and what
    contact lost too.
    """
    trees = []
    for thickness in (1.0, 0.25):
        changes = {f"bodies__{name}__thickness": thickness for name in ("left", "right")}
        scene = two_blocks(
            contact, time__end=0.02, time__output_interval=0.01, output__ledger=True, **changes
        )
        trees.append(mpmfw.run(scene)["series"])
    whole, thin = trees
    energies = [name for name in whole.data_vars if whole[name].attrs.get("units") == "J"]
    assert {"half_step_work", "energy_residual", "contact_work"} <= set(energies)
    assert whole["half_step_work"].values[-1] != 0.0
    assert ("contact_half_step_work" in energies) == (contact in ("penalty", "nodes+penalty"))
    for name in energies:
        np.testing.assert_array_equal(thin[name], 0.25 * whole[name], err_msg=name)


@pytest.mark.parametrize(
    ("contact", "left", "right"),
    [
        ("penalty", 1.0, 0.25),
        ("penalty", 0.25, 1.0),
        *(
            (contact, 2.0, 0.25)
            for contact in ("surfaces+lcp", "barrier", "midplane", "nodes+penalty(kappa=1)")
        ),
    ],
)
def test_two_bodies_touch_over_the_lesser_thickness(contact: str, left: float, right: float) -> None:
    """Squares with sides of 0.5 m: the rows have 0.5 m times the lesser thickness, whichever body comes
    first.
    """

    def area(*thicknesses: float) -> float:
        scene = two_blocks("penalty")
        for body, thickness in zip(scene["bodies"].values(), thicknesses, strict=True):
            body["thickness"] = thickness
        sim = Simulation(scene, contact=contact)
        sim.advance(3)
        rows = sim.contact.last_rows  # type: ignore[union-attr]
        assert rows.count > 0
        return float(rows.area[: rows.count].sum())

    assert area(left, right) == pytest.approx(0.25 * area(1.0, 1.0), rel=1e-2)
    assert area(1.0, 1.0) == pytest.approx(0.5, rel=0.07)  # the squares' corners are no whole rows


def test_traction_acts_on_the_area_of_its_own_body() -> None:
    """Two blocks apart, of two thicknesses: F = τ L t of each."""
    scene = with_no_velocity(two_blocks("separate", time__step=1e-5))
    for name, thickness in (("left", 0.5), ("right", 2.0)):
        scene["bodies"][name] |= {"thickness": thickness, "sides": [{"side": "top", "traction": [3.0, 0.0]}]}
    sim = started(scene)
    sim.advance(5)
    p = sim.state.particles
    for body, thickness in zip(sim.state.bodies, (0.5, 2.0), strict=True):
        own = body.particles
        assert p.mass[own] @ p.velocity[own, 0] == pytest.approx(3.0 * 0.5 * thickness * 5e-5, rel=1e-6)


@pytest.mark.parametrize("contact", ["bardenhagen", "lcp", "penalty"])
def test_forces_go_with_the_thickness_and_motion_does_not(contact: str) -> None:
    trees = []
    for thickness in (None, 4.0):
        scene = two_blocks(contact, time__end=0.01, time__output_interval=0.01)
        if thickness is not None:
            for body in scene["bodies"].values():
                body["thickness"] = thickness
        trees.append(mpmfw.run(scene)["series"])
    assert [tree["kinetic_energy"].attrs["units"] for tree in trees] == ["J m-1", "J"]
    np.testing.assert_allclose(trees[1]["centre_of_mass"], trees[0]["centre_of_mass"], rtol=1e-9)
    scale = np.nanmax(np.abs(trees[0]["contact_force"].values))
    assert scale > 0.0
    np.testing.assert_allclose(
        trees[1]["contact_force"], 4.0 * trees[0]["contact_force"], rtol=1e-9, atol=1e-9 * scale
    )


@pytest.mark.parametrize(
    "loads",
    [
        {"push": {"model": "point_force", "at": [0.2, 0.1], "force": [2e4, 1e4]}},
        {"air": {"model": "drag", "rate": 30.0, "medium": [2.0, 0.0]}},
    ],
)
def test_the_work_of_a_load_is_in_the_ledger(loads: dict[str, Any]) -> None:
    """Work of the load = what the energy grew by and the transfer took away, to a thousandth."""
    scene = block(loads=loads, bodies__solid__velocity=[1.0, 0.5], output__ledger=True)
    series = mpmfw.run(scene)["series"]
    work = series["external_work"].values[-1]
    energy = float(
        (series["total_energy"] + series.get("affine_energy", 0.0)).sum("body")[-1]
        - (series["total_energy"] + series.get("affine_energy", 0.0)).sum("body")[0]
    )
    assert abs(work) > 1.0
    assert energy == pytest.approx(
        work - series["transfer_dissipation"].values[-1], rel=1e-3, abs=1e-3 * abs(work)
    )
    assert "contact_work" not in series


class Wind(SurfaceLoad):
    """Traction c (u − v)·n n where the wind blows on the surface: by place, motion and direction."""

    name = "wind"

    class Options(BaseModel):
        speed: float = 3.0

    def traction(self, facets: LoadedFacets, time: float) -> FloatArray:  # noqa: ARG002
        against = (facets.velocity - [self.options.speed, 0.0])[:, 0] * facets.normal[:, 0]
        return -np.maximum(against, 0.0)[:, None] * facets.normal


class Writing(BodyLoad):
    """Changes what belongs to the step."""

    name = "writing"

    def forces(self, particles: Particles, own: slice, time: float) -> FloatArray:  # noqa: ARG002
        particles.mass[own] *= 0.5
        return np.zeros((own.stop - own.start, particles.dim))


@pytest.fixture
def installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The loads of this module as if they were installed."""
    from importlib.metadata import EntryPoint

    from mpmfw.plugin import discovery

    def entry(name: str) -> EntryPoint:
        return EntryPoint(name.lower(), f"{__name__}:{name}", "mpmfw.load")

    known = discovery.entry_points
    extra = [entry(name) for name in ("Wind", "Writing")]
    monkeypatch.setattr(
        discovery, "entry_points",
        lambda **select: [*known(**select), *(extra if select.get("group") == "mpmfw.load" else [])],
    )  # fmt: skip


@pytest.mark.usefixtures("installed")
def test_a_strangers_traction_by_place_and_motion() -> None:
    """On the left side of 1 m alone: c (u − v_x) pushes towards +x."""
    sim = started(block(loads={"wind": {"model": "wind", "speed": 3.0}}, time__step=1e-4))
    sim.advance(1)
    np.testing.assert_allclose(momentum(sim), [3.0e-4, 0.0], rtol=1e-9, atol=1e-12)
    moving = started(
        block(loads={"wind": {"model": "wind"}}, bodies__solid__velocity=[1.0, 0.0], time__step=1e-4)
    )
    before = momentum(moving)
    moving.advance(1)
    np.testing.assert_allclose(momentum(moving) - before, [2.0e-4, 0.0], rtol=1e-6, atol=1e-10)
    assert any(effect.name == "surfaces" and "wind" in effect.reason for effect in sim.effects)


@pytest.mark.usefixtures("installed")
def test_a_load_cannot_change_what_belongs_to_the_step() -> None:
    with pytest.raises(PluginError, match="changed the material points' masses or initial volumes"):
        mpmfw.run(block(loads={"odd": {"model": "writing"}}))


DRAG = {"model": "drag", "rate": 1.0}
PUSH = {"model": "point_force", "at": [0, 0], "force": [1, 0]}


@pytest.mark.parametrize(
    ("load", "said"),
    [
        ({**DRAG, "model": "darg"}, r"a\.model: no such load plug-in: 'darg'"),
        ({**DRAG, "raet": 1.0}, r"a\.raet: unknown key; did you mean 'rate'"),
        ({**DRAG, "rate": "3 m"}, r"a\.rate: '3 m' is not convertible to 1/s"),
        ({**DRAG, "bodies": ["sold"]}, r"a\.bodies\[0\]: no body 'sold'; did you mean 'solid'"),
        ({**DRAG, "bodies": ["solid", "solid"]}, r"a\.bodies\[1\]: names 'solid' twice"),
        ({**DRAG, "medium": [1, 2, 3]}, r"a\.medium: has 3 entries; expected 2"),
        ({**PUSH, "at": [9, 0]}, r"a\.at: the nearest material point is .* cells away"),
        ({**PUSH, "force": [[0, 1, 0], [0, 2, 0]]}, r"a\.force\[1\]: times must increase"),
    ],
)
def test_a_load_that_cannot_be_meant_is_refused(load: dict[str, Any], said: str) -> None:
    with pytest.raises(SceneError, match=rf"loads\.{said}"):
        Simulation(block(loads={"a": load}))


def test_a_thickness_in_space_and_one_of_nothing_are_refused() -> None:
    with pytest.raises(SceneError, match=r"bodies\.solid\.thickness: must be greater than 0"):
        mpmfw.load_scene(block(bodies__solid__thickness=0.0))
    with pytest.raises(SceneError, match=r"bodies\.solid\.thickness: is for two dimensions"):
        mpmfw.load_scene(box(bodies__solid__thickness=0.5))


def test_a_point_force_asks_for_one_body() -> None:
    with pytest.raises(
        SceneError, match=r"loads\.a\.bodies: a point force acts on one body, not on left, right"
    ):
        Simulation(two_blocks("penalty", loads={"a": PUSH}))
