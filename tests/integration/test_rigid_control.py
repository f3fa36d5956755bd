"""Rigid bodies of which part of the motion is held, which forces press, and belts: closed forms."""

import numpy as np
import pytest
from test_rigid import drop, series_of

import mpmfw
from mpmfw.api.load import SurfaceLoad
from mpmfw.effects import reaction, rigid_motion
from mpmfw.runs.simulation import Simulation


def box(lower, upper, angle=0.0):
    """A rectangle or a box, in the plane turned about the origin."""
    if len(lower) == 3:
        return {"type": "box", "lower": lower, "upper": upper}
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    centre, half = turn @ np.add(lower, upper) / 2.0, np.subtract(upper, lower) / 2.0
    corners = {"lower": (centre - half).tolist(), "upper": (centre + half).tolist()}
    return {"type": "rectangle", **corners, "angle": angle}


def flight(own, **changes):
    """A box of 80 kg that meets nothing."""
    body = {"geometry": box([0.0, 0.0], [0.4, 0.2]), "segment": 0.2, **own}
    body["rigid"] = {"density": 1e3, **own["rigid"]}
    scene = drop(body, output__ledger=True, **changes)
    scene["bodies"]["block"]["geometry"] = box([2.4, -1.3], [2.8, -1.0])
    return scene


def test_pulses_shorter_than_a_step_act_whole():
    """Of a force, and of gravity: 20 N s within a tenth of a millisecond, 1 m/s within as much."""
    pulse = [[0.0, 0.0, 0.0], [0.0301, 0.0, 0.0], [0.03015, 4e5, 0.0], [0.0302, 0.0, 0.0]]
    series = series_of(flight({"rigid": {"force": pulse}}))
    assert series["linear_momentum"].values[-1, 1] == pytest.approx([20.0, 0.0], abs=1e-6)
    fall = [[0.0, 0.0, 0.0], [0.0301, 0.0, 0.0], [0.03015, 0.0, -2e4], [0.0302, 0.0, 0.0]]
    series = series_of(flight({"rigid": {}}, gravity={"table": fall}))
    assert series["mean_velocity"].values[-1, 1] == pytest.approx([0.0, -1.0], abs=1e-6)


@pytest.mark.parametrize("scheme", ["usl", "musl", "usf"])
@pytest.mark.parametrize("held", [[], ["x"], ["y", "rotation"], ["x", "y"]])
def test_a_force_moves_what_is_not_held(held, scheme):
    """F t / m and T t / I; held parts keep the velocity of the start, and their force does its work."""
    acts = np.array([1.0, *(name not in held for name in "xy")])
    rows = acts * [[0.0, 0.0, 30.0], [0.05, 40.0, -30.0], [0.1, 40.0, -30.0]]
    torque = {} if "rotation" in held else {"torque": 2.0}
    own = {"rigid": {"force": rows.tolist(), **torque, "held": held}, "velocity": [1.0, -2.0]}
    series = series_of(flight({**own, "angular_velocity": 0.5}, stepping={"scheme": scheme}))
    time = series["time"].values
    impulse = np.array([np.where(time < 0.05, 400.0 * time**2, 40.0 * time - 1.0),
                        np.where(time < 0.05, 30.0 * time - 600.0 * time**2, 1.5 - 30.0 * time)])  # fmt: skip
    velocity = np.array([[1.0], [-2.0]]) + impulse / 80.0
    spin = 0.5 + 2.0 * time / (80.0 * (0.4**2 + 0.2**2) / 12.0)
    for axis, name in enumerate("xy"):
        velocity[axis] = (1.0, -2.0)[axis] if name in held else velocity[axis]
    spin = 0.5 if "rotation" in held else spin
    found = series["mean_velocity"].values[:, 1].T
    assert found == pytest.approx(velocity, abs=1e-9)  # forces are means over the steps
    inertia = 80.0 * (0.4**2 + 0.2**2) / 12.0
    assert series["angular_momentum"].values[:, 1, 0] == pytest.approx(inertia * spin + 0.0 * time, rel=1e-9)
    energy = series["kinetic_energy"].values[:, 1]
    assert series["external_work"].values == pytest.approx(energy - energy[0], abs=1e-9 * energy[0])


class Blast(SurfaceLoad):
    """A traction on all of a surface, whatever its normal."""

    name = "blast"

    def traction(self, facets, time):  # noqa: ARG002
        return np.tile([30.0, 40.0], (len(facets.area), 1))


@pytest.mark.parametrize("method", ["penalty", "lcp"])
@pytest.mark.parametrize(
    ("load", "force", "torque"),
    [
        ({"model": "point_force", "at": [0.4, 0.0], "force": [30.0, 40.0]}, [30.0, 40.0], 8.0 + 3.0),
        ({"model": "body_force", "force": [30.0, 40.0]}, [30.0 * 0.08, 40.0 * 0.08], 0.0),
        ({"model": "blast"}, [30.0 * 1.2, 40.0 * 1.2], 0.0),
    ],
)  # fmt: skip
def test_loads_move_a_free_rigid_body_that_they_name(announce, load, force, torque, method):
    """And one that they do not name stays; its mass is 80 kg, its circumference 1.2 m."""
    announce("load", "blast", f"{__name__}:Blast")
    scene = flight({"rigid": {}}, contact__method=method, loads={"push": {"bodies": ["disc"], **load}})
    series = series_of(scene)
    assert series["linear_momentum"].values[-1, 1] == pytest.approx(0.1 * np.array(force), rel=1e-9)
    assert series["angular_momentum"].values[-1, 1, 0] == pytest.approx(
        0.1 * torque, rel=5e-3, abs=1e-9
    )  # it turns by 0.04 rad
    gained = series["kinetic_energy"].values[-1, 1]
    assert series["external_work"].values[-1] == pytest.approx(gained, rel=1e-2)
    del scene["loads"]["push"]["bodies"]
    if load["model"] != "point_force":
        assert not series_of(scene)["linear_momentum"].values[:, 1].any()


def test_a_force_by_volume_on_a_rigid_body_is_of_its_thickness():
    push = {"model": "body_force", "bodies": ["disc"], "force": [30.0, 0.0]}
    scene = flight({"rigid": {}, "thickness": 0.5}, loads={"push": push})
    momentum = series_of(scene)["linear_momentum"].values[-1, 1, 0]
    assert momentum == pytest.approx(0.1 * 30.0 * 0.08 * 0.5)


def test_a_point_force_holds_a_rigid_body_on_a_rigid_floor():
    """Contact takes it as it moves the whole body; the plank sank by 0.19 cells where it saw the points."""
    press = {"model": "point_force", "bodies": ["plank"], "at": [0.8, 0.2], "force": [2e3, -1e4]}
    floor = {"geometry": box([-1.0, -0.3], [2.0, 0.0]), "rigid": True}
    scene = drop(floor, "lcp", loads={"press": press})
    scene["bodies"]["plank"] = {"geometry": box([0.0, 0.0], [1.0, 0.2]), "rigid": {"density": 1e3}}
    scene["bodies"]["block"]["geometry"] = box([2.4, -1.3], [2.8, -1.0])
    series = series_of(scene)
    assert np.abs(series["mean_velocity"].values[-1, 2]).max() < 1e-9
    assert series["reaction"].values[-1, 2] == pytest.approx([-2e3, 1e4], rel=1e-6)
    assert series["min_gap"].min() > -1e-5 * 0.1


def test_drag_brakes_a_rigid_body_and_its_spin():
    own = {"rigid": {}, "velocity": [1.0, 0.0], "angular_velocity": 3.0}
    scene = flight(own, loads={"air": {"model": "drag", "bodies": ["disc"], "rate": 4.0}})
    series, simulation = series_of(scene), Simulation(scene)
    simulation.run()
    for name in ("linear_momentum", "angular_momentum"):
        values = series[name].values[:, 1, 0]
        assert values[-1] / values[0] == pytest.approx(np.exp(-0.4), rel=2e-3)
    energy = series["kinetic_energy"].values[:, 1]
    assert simulation.setup.named["loads"]["air"].work == pytest.approx(energy[-1] - energy[0], rel=1e-4)
    assert series["external_work"].values == pytest.approx(energy - energy[0], abs=1e-9 * energy[0])


@pytest.mark.parametrize(
    ("load", "power"),
    [
        ({"model": "drag", "rate": 4.0}, -4.0 * 80.0 * (0.4**2 + 0.2**2) / 12.0 * 3.0**2),
        ({"model": "point_force", "at": [0.2, 0.2], "force": [-20.0, 0.0]}, 20.0 * 0.1 * 3.0),
    ],
)
def test_what_holds_a_spin_takes_the_power_of_the_moment_of_loads(load, power):
    """c I ω² of drag, and T ω of a force for a short time."""
    own = {"rigid": {"held": ["rotation", "x"]}, "angular_velocity": 3.0}
    simulation = Simulation(flight(own, loads={"push": {"bodies": ["disc"], **load}}, time__end=0.02))
    simulation.run()
    assert simulation.setup.named["loads"]["push"].work == pytest.approx(0.02 * power, rel=5e-3)
    assert simulation.state.rigid.work == pytest.approx(-0.02 * power, rel=5e-3)


def test_forces_and_what_holds_do_the_work_that_the_verdict_counts():
    """Of a sledge that is lifted, and goes on at its speed against gravity."""
    own = {"rigid": {"force": [0.0, 300.0], "held": ["x"]}, "velocity": [2.0, 0.0]}
    simulation = Simulation(flight(own, gravity={"vector": [-500.0 / 80.0, 0.0]}))
    simulation.run()
    bodies, forces = simulation.state.rigid, simulation.setup.plugin("rigid_forces")
    risen = 0.5 * 80.0 * (300.0 / 80.0 * 0.1) ** 2
    assert forces.work == pytest.approx(risen)
    assert bodies.work == pytest.approx(500.0 * 2.0 * 0.1)


def in_space(own, **rigid):
    """A box of 8 kg in space that meets nothing, for a fifth of a turn, and its moments of inertia."""
    sides = np.array([0.4, 0.2, 0.1])
    body = {"geometry": box([0.0] * 3, sides.tolist()), "segment": 0.2, "rigid": rigid, **own}
    scene = flight(body, time={"end": 0.3, "output_interval": 0.03})
    scene["grid"] |= {"lower": [-1.0] * 3, "upper": [1.0] * 3}
    scene["bodies"]["block"]["geometry"] = box([-0.7] * 3, [-0.5] * 3)
    return scene, 8.0 * (np.square(sides).sum() - np.square(sides)) / 12.0


def test_in_space_a_torque_does_not_turn_about_axes_that_are_held():
    held = ["rotation-x", "rotation-y"]
    scene, inertia = in_space({"angular_velocity": [0.0, 0.0, 2.0]}, torque=[0.0, 0.0, 0.5], held=held)
    series = series_of(scene)
    spin = 2.0 + 0.5 * series["time"].values / inertia[2]
    energy = series["kinetic_energy"].values[:, 1]
    assert energy == pytest.approx(0.5 * inertia[2] * spin**2, rel=1e-9)
    assert np.abs(series["angular_momentum"].values[:, 1, :2]).max() < 1e-12


def test_in_space_a_body_that_turns_about_two_axes_keeps_their_momentum_and_its_energy():
    """Only a torque about x acts on it. Without the hold ω_x oscillates."""
    own = {"angular_velocity": [0.0, 4.0, 1.0]}
    energies = []
    for held in ([], ["rotation-x"]):
        scene, inertia = in_space(own, held=held)
        simulation, spins = Simulation(scene), []
        simulation.start()
        bodies = simulation.state.rigid
        for _ in range(100):
            simulation.step(1e-3)
            spins.append(bodies.angular_velocity[0])
        energies.append(bodies.kinetic_energy[0])
        moment = rigid_motion.vector_of(bodies.moment)[0]
        assert moment[1:] == pytest.approx(inertia[1:] * [4.0, 1.0], rel=1e-9)
        assert np.ptp(np.array(spins)[:, 2]) > 0.01
    assert np.abs(np.array(spins)[:, 0]).max() < 1e-12
    assert energies == pytest.approx([0.5 * inertia @ np.square([0.0, 4.0, 1.0])] * 2, rel=1e-5)


def test_a_torque_that_keeps_a_spin_does_the_work_that_the_body_gains():
    scene, _ = in_space({"angular_velocity": [5.0, 5.0, 0.3]}, density=1e3, held=["rotation-x"])
    series = series_of(scene)
    energy = series["kinetic_energy"].values[:, 1]
    assert np.ptp(energy) > 0.3 * energy[0]
    assert series["external_work"].values == pytest.approx(energy - energy[0], abs=1e-3 * energy[0])


def test_a_body_with_a_held_axis_turns_as_before_beside_one_that_is_free():
    turns, scene = [], in_space({"angular_velocity": [0.0, 5.0, 3.0]}, held=["rotation-x"])[0]
    top = {"geometry": box([1.5, 1.5, 1.5], [1.8, 1.7, 1.6]), "rigid": {"density": 1e3}}
    for others in ({}, {"top": {**top, "angular_velocity": [1.0, 2.0, 3.0]}}):
        simulation = Simulation({**scene, "bodies": {**scene["bodies"], **others}})
        for _ in range(5):
            simulation.step(1e-3)
        turns.append(simulation.state.rigid.turn[0])
    np.testing.assert_array_equal(*turns)


@pytest.mark.parametrize("least", [0.0, 1e-12])
def test_a_rod_is_refused_where_a_rotation_is_held(least):
    rod = {"mass": 1.0, "inertia": [least, 1.0, 1.0]}
    scene, _ = in_space({}, density=None, **rod, held=["rotation-x"])
    del scene["bodies"]["disc"]["rigid"]["density"]
    with pytest.raises(mpmfw.errors.SceneError, match=r"rigid\.inertia: .* held about one axis"):
        mpmfw.load_scene(scene)


@pytest.mark.parametrize(
    ("held", "torque", "message"),
    [
        (["rotation", "rotation-z"], None, "held: holds rotations about all axes; expected 'rotation' alone"),
        (["rotation-x", "rotation-y", "rotation-z"], None, "held: holds rotations about all axes"),
        (["rotation-y"], [1.0, 2.0, 0.0], "torque: has no effect: rotation-y is held; expected 0 there"),
        (["rotation-w"], None, "did you mean 'rotation-z'"),
    ],
)
def test_bad_holds_are_refused(held, torque, message):
    scene, _ = in_space({}, held=held, **({"torque": torque} if torque else {}))
    with pytest.raises(mpmfw.errors.SceneError, match=message):
        mpmfw.load_scene(scene)


def test_impulses_do_not_turn_a_body_about_an_axis_that_is_held():
    scene, inertia = in_space({}, held=["rotation-x", "y"])
    bodies = Simulation(scene).state.rigid
    impulse = np.random.default_rng(2).normal(size=(4, 3))
    arms, moment = bodies.arms[0], np.cross(bodies.arms[0], impulse).sum(axis=0)
    velocity = np.array([1.0, 0.0, 1.0]) * impulse.sum(axis=0) / 8.0
    moved = velocity + np.cross([0.0, 1.0, 1.0] * moment / inertia, arms)
    assert np.einsum("pdqe,pd->qe", bodies.inverse_mass, impulse) == pytest.approx(moved, abs=1e-12)


@pytest.mark.parametrize(
    ("method", "rotation"),
    [
        *((method, ["rotation"]) for method in ("penalty", "lcp", "midplane", "bardenhagen")),
        pytest.param("impulse", ["rotation"], marks=pytest.mark.long),
        *((method, []) for method in ("penalty", "lcp")),
    ],
)
def test_a_punch_under_a_force_compresses_a_column(method, rotation):
    """Settled, the column is shorter by F L / (w (K + 4 G / 3)), and the reaction is the force."""
    punch = {"density": 1e3, "held": ["x", *rotation], "force": [0.0, -4e3]}
    scene = drop({"geometry": box([-0.5, 1.0], [2.5, 1.3]), "segment": 0.1, "rigid": punch}, method)
    walls = [{"side": "bottom", "fixed": True}, *({"side": s, "fixed": ["x"]} for s in ("left", "right"))]
    scene["bodies"]["block"] |= {"geometry": box([0.0, 0.0], [2.0, 1.0]), "sides": walls}
    series = series_of({**scene, "settle": {}, "time": {"end": 2e-3, "output_interval": 2e-3}})
    within = 0.015 if method == "bardenhagen" else 0.01
    shortening = 4e3 / 2.0 / (1e6 + 4.0 / 3.0 * 5e5)
    assert 0.5 - series["centre_of_mass"].values[-1, 0, 1] == pytest.approx(0.5 * shortening, rel=within)
    assert series["reaction"].values[-1, 1, 1] == pytest.approx(4e3, rel=within)
    assert series["centre_of_mass"].values[-1, 1, 0] == pytest.approx(1.0, abs=1e-12)
    assert abs(series["mean_velocity"].values[-1, 1, 1]) < 1e-3


@pytest.mark.parametrize("angle", [0.0, 0.35])
@pytest.mark.parametrize("method", ["penalty", "lcp", "midplane", "bardenhagen"])
def test_a_box_on_a_belt_reaches_its_speed(method, angle):
    """a = μ g up to the belt's velocity V; the belt's work is m V², of which friction takes half."""
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    belt = {"motion": {"surface_velocity": (turn @ [0.5, 0.0]).tolist()}}
    scene = drop({"geometry": box([-0.8, -0.5], [2.8, 0.0], angle), "rigid": belt}, method, settle={})
    scene["bodies"]["block"] |= {"geometry": box([0.0, 0.0], [0.4, 0.2], angle), "particles": {"size": 0.05}}
    scene["materials"]["soft"] |= {"bulk_modulus": 4e6, "shear_modulus": 2e6}
    scene |= {"gravity": {"vector": (turn @ [0.0, -10.0]).tolist()}}
    scene |= {"time": {"end": 0.25, "output_interval": 0.01}, "output": {"ledger": True}}
    series = series_of(scene)
    time, speed = series["time"].values, series["mean_velocity"].values[:, 0] @ turn[:, 0]
    slips = (time > 0.02) & (time < 0.14)
    assert np.polyfit(time[slips], speed[slips], 1)[0] == pytest.approx(
        3.0, rel=0.15 if "bar" in method else 0.02
    )
    assert speed[-1] == pytest.approx(0.5, rel=0.01)
    assert series["external_work"].values[-1] == pytest.approx(80.0 * 0.5**2, rel=0.01)
    assert series["frictional_work"].values[-1, 0] == pytest.approx(40.0 * 0.5**2, rel=0.07)
    assert np.ptp(series["centre_of_mass"].values[:, 1], axis=0).max() == 0.0


@pytest.mark.parametrize("method", ["lcp", "impulse"])
def test_a_belt_does_not_push_a_rigid_box_by_its_nodes(method):
    """One of them lies at the box's corner: as a slave the belt would move it into the box."""
    belt = {"geometry": box([-0.9, -0.5], [2.9, 0.0]), "rigid": {"motion": {"surface_velocity": [0.5, 0.0]}}}
    scene = drop(belt, method, gravity={"vector": [0.0, -10.0]})
    scene["bodies"]["block"]["geometry"] = box([2.0, 0.0], [2.4, 0.3])
    scene["bodies"]["box"] = {"geometry": box([0.0, 0.0], [0.4, 0.3]), "rigid": {"density": 1e3}}
    velocity = series_of(scene)["mean_velocity"].sel(body="box", axis="x")
    assert velocity.values == pytest.approx(3.0 * velocity["time"].values, abs=2e-3)


@pytest.mark.parametrize("method", ["penalty", "lcp", "bardenhagen"])
def test_a_run_says_that_contact_pushes_along_a_belt(method):
    def warnings(belt):
        body = {"geometry": box([-0.8, -0.5], [2.8, 0.0]), "rigid": {"motion": {"surface_velocity": belt}}}
        scene = drop(body, method, gravity={"vector": [0.0, -10.0]}, time__end=0.02)
        scene["bodies"]["block"] |= {"geometry": box([0.0, 0.0], [0.4, 0.2]), "velocity": [0.0, -1.0]}
        simulation = Simulation(scene)
        simulation.run()
        return [text for text in simulation.concerns() if "along its surface_velocity" in text]

    assert warnings([0.5, 0.0]) == []
    assert len(warnings([0.0, 0.5])) == len(warnings([0.5, 0.2])) == 1
    assert 0.0 < reaction.ALONG < 0.2 / np.hypot(0.5, 0.2)


def test_a_wheel_that_spins_on_a_bed_is_braked_by_the_moment_of_friction():
    """μ W R, which does the work −μ W R ω t; contact at nodes has more than twice of it."""
    wheel = {"rigid": {"density": 1e3, "held": ["rotation"]}, "angular_velocity": -10.0, "segment": 0.025}
    geometry = {"type": "disc", "centre": [1.0, 0.7], "radius": 0.4}
    scene = drop({"geometry": geometry, **wheel}, settle={}, output__ledger=True)
    scene["bodies"]["block"]["sides"] = [{"side": "bottom", "fixed": True}]
    series = series_of({**scene, "gravity": {"vector": [0.0, -10.0]}})
    moment = 0.3 * 1e4 * np.pi * 0.4**3
    assert series["reaction_moment"].values[-5:, 1, 0].mean() == pytest.approx(moment, rel=0.01)
    assert series["external_work"].values[-1] == pytest.approx(10.0 * 0.1 * moment, rel=0.03)
    assert np.ptp(series["angular_momentum"].values[:, 1, 0]) < 1e-9 * 500.0


def test_the_roller_is_pressed_as_johnson_says_and_rolls_with_half_of_the_floors_velocity():
    tree = mpmfw.run("roller", set={"time.end": 0.4, "output.particles": False, "output.surface": False})
    series, force = tree["series"], 5e4 / (6e6 / (1.0 - 0.3**2))
    half_width = np.sqrt(4.0 * force / np.pi)
    shorter = 2.0 * force / np.pi * (2.0 * np.log(4.0 / half_width) - 1.0)
    place, time = series["centre_of_mass"].values, series["time"].values
    assert 2.1 - place[0, 2, 1] == pytest.approx(shorter, rel=0.02)
    rolls = time > 0.2
    assert np.polyfit(time[rolls], place[rolls, 0, 0], 1)[0] == pytest.approx(0.5, rel=0.02)
    assert series["angular_momentum"].values[rolls, 0].mean() / (500.0 * np.pi) == pytest.approx(
        0.5, rel=0.05
    )
    assert "warnings" not in tree.attrs  # what presses does the work


@pytest.mark.parametrize(("method", "within"), [("lcp", 1e-6), ("impulse", 1e-5), ("hybrid", 2e-5)])
def test_free_rigid_bodies_lie_on_a_rigid_floor(method, within):
    """With points of mass that move one by one a disc sank at 4 g Δt."""
    floor = {"geometry": box([-1.0, -0.5], [3.0, 0.0]), "rigid": True}
    scene = drop(floor, method, gravity={"vector": [0.0, -10.0]})
    disc = {"geometry": {"type": "disc", "centre": [1.0, 0.4], "radius": 0.4}, "rigid": {"density": 1e3}}
    scene["bodies"] |= {
        "ball": disc,
        "cube": {"geometry": box([0.0, 0.0], [0.3, 0.3]), "rigid": {"density": 1e3}},
    }
    scene["bodies"]["block"]["geometry"] = box([2.2, 0.0], [2.6, 0.3])
    series = series_of(scene)
    place = series["centre_of_mass"].values
    assert np.abs(place[-1, 2:] - place[0, 2:]).max() < within
    assert series["reaction"].values[-1, 3, 1] == pytest.approx(900.0, rel=1e-5)


@pytest.mark.parametrize("friction", [0.0, 0.9])
def test_impulses_on_free_rigid_bodies_stop_them_and_give_no_energy(friction):
    """Blocks fall on a floor and against each other; each row by itself let them in by 0.2 cells."""
    floor = {"geometry": box([-1.0, -0.5], [3.0, 0.0]), "rigid": True}
    scene = drop(floor, "impulse", contact__friction=friction, time__end=0.25)
    for k, (angle, speed, spin) in enumerate([(0.3, 1.0, 8.0), (-0.7, 0.0, -5.0), (1.0, -2.0, 3.0)]):
        geometry = box([0.6 * k - 0.4, 0.5], [0.6 * k, 0.5 + 0.15 * (k + 1)]) | {"angle": angle}
        body = {"geometry": geometry, "segment": 0.05, "rigid": {"density": 10.0 ** (2 + k)}}
        scene["bodies"][f"b{k}"] = body | {"velocity": [speed, -4.0], "angular_velocity": spin}
    scene["bodies"]["block"]["geometry"] = box([2.2, 0.0], [2.6, 0.3])
    series = series_of(scene)
    energy = series["kinetic_energy"].values[:, 2:].sum(axis=1)
    assert np.diff(energy).max() < 1e-12 * energy[0]
    assert energy[-1] < 0.5 * energy[0]
    assert series["min_gap"].min() > -0.1 * 0.1


def test_points_of_a_body_that_cannot_turn_show_its_mass_alone():
    """Of a corner 1 + 6 (1 / 100)² times, without its distance 7 times."""
    own = {"rigid": {"held": ["rotation"]}}
    bodies = Simulation(flight(own)).state.rigid
    weight = bodies.weights_at(0, np.array([[0.4, 0.2]]))
    assert (3.0 * weight**2).sum() == pytest.approx(1.0006, rel=1e-6)
    assert rigid_motion.FAR > 10.0
