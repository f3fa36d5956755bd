"""What goes wrong is named: body, point, position, time and what to do; what was reached is kept."""

import math

import numpy as np
import pytest

import mpmfw
from contact_scenes import CELL, impact, wave_speed
from mpmfw.errors import SceneError, SimulationError
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import disc, two_blocks

LEAVES = disc(bodies__solid__velocity=[20.0, 0.0], time={"end": 0.1, "output_interval": 0.02})


def assert_named(error, what):
    """The message says what, which body and point, where, when, and what to try."""
    message = str(error)
    for part in (what, "body 'solid'", f"point {error.index}", "at (", " m", "at time", "Try: "):
        assert part in message
    assert error.body == "solid"
    assert isinstance(error.index, int)
    assert error.time is not None
    assert error.advice


@pytest.mark.parametrize("shape", ["linear", "cpdi2"])
def test_a_body_that_leaves_the_grid(shape):
    with pytest.raises(SimulationError) as caught:
        mpmfw.run(LEAVES, shape=shape)
    error = caught.value
    assert_named(error, "a material point left the grid")
    assert "larger grid" in str(error.advice)
    assert error.position is not None
    # the front runs from 1.03 m at 20 m/s, 25 mm a step, and stops where the last support ends, within a cell
    # and a half of 2 m
    assert 1.6 < error.position[0] < 2.03
    assert 0.02 < error.time < 0.052  # the front reaches 2 m at 0.0485 s; two steps more


@pytest.mark.parametrize(
    ("field", "value", "what"),
    [
        ("velocity", np.nan, "a value became NaN"),
        ("deformation_gradient", np.diag([-1.0, 1.0]), "a material point inverted (det F = -1)"),
    ],
)
def test_what_a_point_cannot_have_is_named(field, value, what):
    sim = Simulation(disc())
    sim.advance(3)
    getattr(sim.state.particles, field)[11] = value
    with pytest.raises(SimulationError) as caught:
        sim.advance(3)
    assert_named(caught.value, what)
    assert field == "velocity" or caught.value.index == 11


def test_the_index_counts_within_the_body():
    sim = Simulation(two_blocks("separate"))
    sim.advance(1)
    first = sim.state.bodies[1].particles.start
    sim.state.particles.deformation_gradient[first + 2] = np.diag([-1.0, 1.0])
    with pytest.raises(SimulationError) as caught:
        sim.advance(1)
    assert (caught.value.body, caught.value.index) == ("right", 2)


@pytest.mark.parametrize(
    ("time", "key"),
    [({"step": 2.6e-3}, "time.step"), ({"safety": 1.1}, "time.safety")],
)
def test_a_step_past_the_limit_is_refused(time, key):
    scene = disc(time={"end": 0.05, "output_interval": 0.05, **time})
    with pytest.raises(SceneError, match=key):
        Simulation(scene)
    scene["allow_unstable"] = True
    assert Simulation(scene).stable_step() == pytest.approx(time.get("step", 1.1 * 2.5e-3))


def test_a_step_past_the_limit_of_the_meeting_nodes_is_refused_when_it_shows():
    """Surfaces that meet in the middle of a cell share its nodes, which lowers the limit after the build."""
    mapping = impact(right="soft")
    limit = CELL / wave_speed("soft") / math.sqrt(1.0 + 4.0)  # 2 / sqrt(ω_bulk² (1 + κ)) of equal bodies
    mapping["time"] = {"end": 0.1, "output_interval": 0.05, "step": 0.99 * limit}
    mapping["contact"] = {"method": "penalty", "friction": 0.3}
    for body in mapping["bodies"].values():
        for corner in ("lower", "upper"):
            body["geometry"][corner][0] -= 0.02
    with pytest.raises(SimulationError, match="stability limit"):
        mpmfw.run(mapping)
    mapping["time"]["step"] = 1.01 * limit  # past that of equal bodies, which is known before any meet
    with pytest.raises(SceneError, match=r"penalty springs and bulk; expected a smaller time\.step"):
        Simulation(mapping)


def test_initial_overlap_is_refused_unless_allowed():
    overlapping = impact(gap=-0.02)
    overlapping["contact"] = {"method": "penalty", "friction": 0.3}
    overlapping["time"] = {"end": 0.01, "output_interval": 0.01}
    with pytest.raises(SceneError, match=r"bodies\.left: overlaps body .right.*allow_overlap"):
        mpmfw.run(overlapping)
    result = mpmfw.run({**overlapping, "allow_overlap": True})
    assert result.attrs["status"] == "ok"
    assert float(result["series"]["min_gap"][0, 0]) == pytest.approx(-0.02, abs=1e-12)


def test_a_body_outside_the_grid_is_refused():
    with pytest.raises(SceneError, match="solid"):
        Simulation(disc(grid__upper=[1.0, 2.0]))


@pytest.mark.parametrize("name", ["body", "axis", "particle", "series"])
def test_a_body_may_have_any_name_that_a_scene_accepts(name):
    scene = disc()
    scene["bodies"] = {name: scene["bodies"]["solid"]}
    try:
        scene = mpmfw.load_scene(scene)
    except SceneError:
        return
    tree = mpmfw.run(scene)
    assert tree["series"]["body"].values.tolist() == [name]
    assert list(tree["particles"].children) == [name]


def advice(contact):
    """Of the error that ends the run, which went well before the bodies met."""
    with pytest.raises(SimulationError, match="the stable time step fell to") as error:
        Simulation(two_blocks("none"), contact=contact).advance(2000)
    return error.value.advice


def test_of_springs_the_keys_of_the_scene_are_named():
    """Of a joined contact those of its parts' tables."""
    said = advice("surfaces+penalty(kappa=1e12)")
    assert "contact.penalty.kappa" in said
    assert "contact.surfaces.map" in said
    step = Simulation(two_blocks("none"), contact="penalty")._time_step
    assert step._advice("drag") == "another shape function"  # a contact that sets no limit is not named
