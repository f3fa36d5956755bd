"""Sides act where they lie: anywhere in a cell, on turned bodies, and where they move to."""

import math

import numpy as np
import pytest
from test_restart import stop_and_go_on

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import BULK, DENSITY, SHEAR, block, box, disc, one_body, with_changes

SPEED = math.sqrt((BULK + 4.0 * SHEAR / 3.0) / DENSITY)


def uniaxial(stretch):
    """σ_yy of the Neo-Hookean material at F = diag(1, stretch) [Pa]."""
    j = stretch
    return 0.5 * BULK * (j - 1.0 / j) + SHEAR * j ** (-5.0 / 3.0) * (j * j - (2.0 + j * j) / 3.0)


def confined(h, offset, strain, **changes):
    """A square of 1 m, `offset` cells past a grid line, driven to a strain at 0.002 c."""
    x = offset * h
    geometry = {"type": "rectangle", "lower": [x - 0.5] * 2, "upper": [x + 0.5] * 2}
    sides = [
        {"side": "bottom", "fixed": ["y"]},
        {"side": "left", "fixed": ["x"]},
        {"side": "right", "fixed": ["x"]},
        {"side": "top", "velocity": ["free", -math.copysign(0.002 * SPEED, strain)]},
    ]
    end = abs(strain) / (0.002 * SPEED)
    scene = one_body(geometry, size=0.5 * h, layout="fitted", bodies__solid__sides=sides)
    scene["grid"] = {"cell_size": h, "lower": [-2.0] * 2, "upper": [2.0] * 2}
    return with_changes(scene, time={"end": end, "output_interval": end}, **changes)


def driven(scene):
    """Stresses at the end along the body's own axes."""
    sim = Simulation(scene)
    sim.run()
    axes = sim.scene.bodies["solid"].geometry.axes
    stress: np.ndarray = axes @ sim.state.particles.stress @ axes.T
    return stress


@pytest.mark.parametrize(
    ("shape", "scheme", "strain", "limit"),
    [
        *(("cpdi", "usl", -0.1, 0.02), ("cpdi2", "usl", 0.1, 0.02), ("bspline", "usl", 0.1, 0.3)),
        *(("cpdi", "musl", 0.1, 0.03), ("cpdi", "usf", 0.1, 0.03)),
    ],
)
def test_a_driven_block_is_strained_uniformly(shape, scheme, strain, limit):
    """From rest: 2 % is the jump of stress with which the side starts. The validation case ``driven-side``
    judges offsets, sizes of cells and turned blocks; points of B-splines do not end with the side."""
    stress = driven(confined(0.2, 0.3, strain, shape__method=shape, stepping__scheme=scheme))
    exact = uniaxial(1.0 - strain)
    assert stress[:, 1, 1].mean() == pytest.approx(exact, rel=0.02)
    np.testing.assert_allclose(stress[:, 1, 1], exact, rtol=limit)
    if shape != "bspline":
        np.testing.assert_allclose(stress[:, 0, 1], 0.0, atol=1e-3 * abs(exact))


@pytest.mark.parametrize("angle", [0.0, 0.5, None])
def test_the_moment_of_a_side_carries_the_weight_and_its_lever(angle):
    """At rest it is (x_c − x_0) × F about any point, with the side's force F; without an angle in space."""
    make, about, g = (box, [0.1, 0.2, 0.3], [5, -7, 3]) if angle is None else (block, [0.3, -0.7], [3, -2])
    scene = make(bodies__solid__sides=[{"side": "bottom", "fixed": True}], gravity={"vector": g}, settle={})
    scene |= {"output": {"side_moment": about}, "time": {"end": 1e-3, "output_interval": 1e-3}}
    if angle is not None:
        scene["bodies"]["solid"]["geometry"]["angle"] = angle
    series = mpmfw.run(scene)["series"].isel(time=-1, body=0)
    arm, force = (
        series["centre_of_mass"].values - about,
        series["side_reaction"].sel(side="solid-bottom").values,
    )
    expected = np.cross(arm, force) if angle is None else [arm[0] * force[1] - arm[1] * force[0]]
    assert series["side_moment"].sel(side="solid-bottom").values == pytest.approx(
        np.array(expected), rel=0.02
    )
    assert series["side"].values.tolist() == ["solid-bottom"]


def test_conditions_on_one_side_have_one_reaction():
    """The sum of both: the same as of a side that is fixed at once."""
    time, runs = {"end": 1e-3, "output_interval": 1e-3}, []
    for fixed in ([True], [["x"], ["y"]]):
        sides = [{"side": "bottom", "fixed": each} for each in fixed]
        scene = block(bodies__solid__sides=sides, gravity={"vector": [3.0, -10.0]}, settle={}, time=time)
        runs.append(mpmfw.run(scene)["series"].isel(time=-1))
    both, one = runs
    assert one["side"].values.tolist() == both["side"].values.tolist() == ["solid-bottom"]
    assert (np.abs(both["side_reaction"]) > 0.0).all()
    np.testing.assert_allclose(one["side_reaction"], both["side_reaction"], rtol=5e-3)  # as settled


def test_a_moment_without_a_prescribed_side_is_refused():
    with pytest.raises(SceneError, match="side_moment: has no effect: no side is fixed or driven"):
        mpmfw.load_scene(block(output={"side_moment": [0.0, 0.0]}))


@pytest.mark.parametrize(("scheme", "angle"), [("usl", 0.3), ("musl", 0.0), ("usf", 0.3)])
def test_forces_of_sides_are_what_changes_the_momentum_and_do_the_work(scheme, angle):
    """A heavy block that is pressed from above."""
    sides = [{"side": "bottom", "fixed": True}, {"side": "top", "velocity": [0.0, -0.01 * SPEED]}]
    scene = block(
        bodies__solid__geometry__angle=angle, bodies__solid__sides=sides, gravity={"vector": [3.0, -10.0]},
        stepping__scheme=scheme, output={"ledger": True, "particles": False},
    )  # fmt: skip
    series = mpmfw.run(scene)["series"].sel(body="solid")
    interval = np.diff(series["time"])
    change = np.diff(series["linear_momentum"].values, axis=0) / interval[:, None]
    force = series["side_reaction"].sum("side").values[1:]
    weight = (change - force).mean(axis=0)
    np.testing.assert_allclose(change - force, np.tile(weight, (len(force), 1)), rtol=1e-8)
    assert weight[0] / weight[1] == pytest.approx(-0.3, rel=1e-9)
    work = series["side_work"].sel(side=["solid-bottom", "solid-top"]).values[-1]
    assert work[0] == 0.0
    assert work[1] == pytest.approx(float(series["external_work"][-1]), rel=0.02)  # of the mean velocity


def in_time(*speeds, scheme="usl", **changes):
    """A square whose top has these speeds along y, 0.1 s apart."""
    rows = [[0.1 * k, "free", speed] for k, speed in enumerate(speeds)]
    sides = [{"side": "bottom", "fixed": ["y"]}, {"side": "top", "velocity": rows}]
    end = 0.1 * (len(speeds) - 1)
    return block(
        bodies__solid__sides=sides, time={"end": end, "output_interval": 0.005}, output={"ledger": True},
        stepping={"scheme": scheme}, **changes,
    )  # fmt: skip


@pytest.mark.parametrize("scheme", ["usl", "musl", "usf"])
def test_a_side_takes_velocities_over_time(scheme, tmp_path):
    """It moves by their integral, does their work, and goes on to the bit."""
    scene = in_time(0.0, -0.3, 0.1, 0.1, scheme=scheme)
    sim = Simulation(scene)
    frames = []
    sim.run(write=lambda frame: frames.append(frame.series))
    constraint = sim.registry.plugins["constraint"]
    begin = Simulation(scene).registry.plugins["constraint"].planes.place
    np.testing.assert_allclose((constraint.planes.place - begin), [0.0, -0.015], rtol=1e-9, atol=1e-15)
    series = {
        k: np.array([frame[k] for frame in frames]) for k in ("side_reaction", "side_work", "linear_momentum")
    }
    times = np.linspace(0.0, 0.3, len(frames))
    force, top = series["side_reaction"][1:], 1
    change = np.diff(series["linear_momentum"][:, 0], axis=0)
    np.testing.assert_allclose(force.sum(axis=1) * np.diff(times)[:, None], change, rtol=1e-6, atol=1e-6)
    speed = np.interp(0.5 * (times[1:] + times[:-1]), [0.0, 0.1, 0.2, 0.3], [0.0, -0.3, 0.1, 0.1])
    work = (force[:, top, 1] * speed) @ np.diff(times)
    assert series["side_work"][-1, top] == pytest.approx(work, rel=2e-3)
    assert frames[-1]["external_work"] == pytest.approx(work, rel=0.06)  # of the mean velocity
    stop_and_go_on(lambda: Simulation(scene), tmp_path / "saved", 40)


def test_a_table_of_one_velocity_is_that_velocity():
    scene, ends = in_time(-0.2, -0.2), []
    for velocity in (scene["bodies"]["solid"]["sides"][1]["velocity"], ["free", -0.2]):
        scene["bodies"]["solid"]["sides"][1]["velocity"] = velocity
        sim = Simulation(scene)
        sim.run()
        ends.append(sim.state.particles.position.copy())
    np.testing.assert_allclose(*ends, rtol=1e-12)


def test_a_side_with_a_table_stands_still_while_the_scene_settles():
    scene = in_time(-0.2, 0.2, gravity={"vector": [0.0, -10.0]}, settle={"tolerance": 1e-2})
    sim, places = Simulation(scene), []
    constraint = sim.registry.plugins["constraint"]
    sim.run(after_step=lambda: places.append((sim.started, *constraint.planes.place)))
    assert {tuple(place) for started, *place in places if not started} == {tuple(places[0][1:])}


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([[0, "free", 1], [1, 0, 1]], "leaves a component free in some rows"),
        ([[0, "free", "free"], [1, "free", "free"]], "every component is free"),
        ([[0, 0, 1], [0, 0, 2]], "times must increase"),
        ([[0, 0, 1, 1], [1, 0, 1, 1]], "expected the time and 2 components"),
        ([[0, 0, 0], [1, 0.5, 0]], r"prescribes 0.5 m/s along x at 1 s, but side 'bottom', with which"),
        ([["0 s", "free", 0], ["0.2 s", "free", -10]], "meets side 'bottom' at 0.2 s"),
    ],
)
def test_wrong_velocities_over_time_are_refused(rows, said):
    sides = [{"side": "bottom", "fixed": True}, {"side": "right", "velocity": rows}]
    if "meets" in said:
        sides[1]["side"] = "top"
    with pytest.raises(SceneError, match=said):
        Simulation(block(bodies__solid__sides=sides, time__end=0.5))


def test_a_side_that_is_free_along_its_normal_goes_with_the_body():
    # A cell and a half upwards, and pushed sideways all the way
    scene = block(
        bodies__solid__sides=[{"side": "bottom", "fixed": ["x"]}, {"side": "top", "fixed": ["x"]}],
        bodies__solid__velocity=[0.0, 4.0],
        gravity={"vector": [20.0, 0.0]},
    )
    sim = Simulation(scene)
    sim.start()
    p = sim.state.particles
    begin = p.position.copy()
    while sim.state.time < 0.09:
        sim.step(sim.stable_step())
    moved = p.position - begin
    np.testing.assert_allclose(moved[:, 1], 4.0 * sim.state.time, rtol=0.02)
    assert np.abs(moved[:, 0]).max() < 0.1 * 0.5 * 20.0 * sim.state.time**2


def test_a_box_is_driven_by_its_side():
    strain, rate = 0.02, 0.002 * SPEED
    walls = [("bottom", "y"), ("left", "x"), ("right", "x"), ("back", "z"), ("front", "z")]
    sides = [{"side": side, "fixed": [axis]} for side, axis in walls]
    end = strain / rate
    time = {"end": end, "output_interval": end}
    top = {"side": "top", "velocity": ["free", -rate, "free"]}
    stress = driven(box(time=time, bodies__solid__sides=[*sides, top], bodies__solid__particles__size=0.25))
    np.testing.assert_allclose(stress[:, 1, 1], uniaxial(1.0 - strain), rtol=0.06)


def test_the_step_needs_no_new_limit_for_a_sliver():
    # A side that reaches into a cell by a hundredth, at 0.9 of the bulk limit: energy would grow if anything
    # did
    scene = block(
        bodies__solid__geometry__lower=[-0.5, -0.5025],
        bodies__solid__geometry__upper=[0.5, 0.4975],
        bodies__solid__sides=[{"side": "bottom", "fixed": True}],
        bodies__solid__velocity=[1.0, 0.0],
        time__safety=0.75,
        output__ledger=True,
        time__end=0.2,
        time__output_interval=0.2,
    )
    sim = Simulation(scene)
    sim.run()
    assert np.abs(sim.state.particles.velocity).max() < 3.0


@pytest.mark.parametrize("condition", [{"fixed": True}, {"velocity": [0.0, 1.0]}])
def test_a_body_without_a_plane_side_is_refused(condition):
    with pytest.raises(SceneError, match=r"bodies.solid.sides\[0\].side: a disc has no plane side"):
        Simulation(disc(bodies__solid__sides=[{"side": "bottom", **condition}]))
    corner = {"type": "polygon", "points": [[0.0, -0.5], [0.5, 0.0], [0.0, 0.5], [-0.5, 0.0]]}
    scene = one_body(corner, size=0.125, bodies__solid__sides=[{"side": "bottom", **condition}])
    with pytest.raises(SceneError, match="no part of the outline lies along the side 'bottom'"):
        Simulation(scene)
