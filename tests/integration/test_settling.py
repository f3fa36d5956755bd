"""Settling: under which loads it happens, and what stays after it."""

import numpy as np
import pytest
from test_restart import stop_and_go_on

import mpmfw
from mpmfw.runs.simulation import Simulation
from scenes_for_tests import DENSITY, disc, scene_of, solid, two_blocks

HEIGHT, G = 0.5, 10.0


STIFF = {"model": "neo_hookean", "density": DENSITY, "bulk_modulus": 12e6, "shear_modulus": 6e6}


def column(**tables):
    """A column on a fixed bottom, held sideways, of the height 0.5 m."""
    walls = [{"side": "left", "fixed": ["x"]}, {"side": "right", "fixed": ["x"]}]
    made = solid([0.0, 0.0], [0.3, HEIGHT], 0.05, sides=[{"side": "bottom", "fixed": True}, *walls])
    return scene_of({"column": made}, 0.1, [-0.3, -0.3], [0.6, 1.2], end=0.01, **{"settle": {}, **tables})


def least_stress(scene):
    """Mean σ_yy over the points of the lowest row of cells after settling [Pa]."""
    sim = Simulation(scene)
    sim.start()
    lowest = sim.state.particles.position[:, 1] < 0.1
    return float(sim.state.particles.stress[lowest, 1, 1].mean())


#: Weight of what lies above the middle of the lowest row of cells, whose linear functions know one stress.
EXPECTED = -DENSITY * G * (HEIGHT - 0.05)


def test_a_table_of_gravity_settles_under_its_value_at_time_zero():
    table = [[0.0, 0.0, -G], [0.02, 0.0, 0.0]]
    assert least_stress(column(gravity={"table": table})) == pytest.approx(EXPECTED, rel=0.01)


def test_gravity_of_settling_alone_acts_while_settling_alone():
    scene = column(settle={"gravity": {"vector": [0.0, -G]}})
    assert least_stress(scene) == pytest.approx(EXPECTED, rel=0.01)
    sim = Simulation(scene)
    sim.start()
    assert (sim.registry.plugins["gravity"].at(0.0) == 0.0).all()


def test_a_run_that_goes_on_settles_by_its_tolerance_in_the_same_step(tmp_path):
    """The residual is a mean over the last steps."""
    scene = column(gravity={"vector": [0.0, -G]}, settle={"tolerance": 0.2})
    stop_and_go_on(lambda: Simulation(scene), tmp_path / "saved", 30)


def test_a_moving_side_rests_while_the_scene_settles():
    scene = column(gravity={"vector": [0.0, -G]})
    scene["bodies"]["column"]["sides"][0] = {"side": "bottom", "velocity": [0.0, 1.0]}
    sim = Simulation(scene)
    sim.start()
    assert np.abs(sim.state.particles.position[:, 1].min() - 0.025) < 1e-3
    sim.run()
    assert sim.state.particles.position[:, 1].min() == pytest.approx(0.025 + 0.01, abs=2e-3)


def test_a_side_holds_its_own_body_alone_in_a_shared_field():
    """The right block flies away from the left one, which is held."""
    scene = two_blocks("none", time={"end": 0.1, "output_interval": 0.1})
    scene["bodies"]["left"]["sides"] = [{"side": "right", "fixed": True}]
    scene["bodies"]["right"] |= {"velocity": [1.0, 0.0]}
    scene["bodies"]["right"]["geometry"] = {"type": "rectangle", "lower": [1.0, -0.25], "upper": [1.3, 0.25]}
    sim = Simulation(scene)
    sim.run()
    moved = sim.state.particles.position[sim.state.bodies[1].particles, 0].mean() - 1.15
    assert moved == pytest.approx(0.1, rel=1e-9)


@pytest.mark.parametrize("shape", ["linear", "cpdi"])
def test_apic_starts_with_the_spin_that_was_asked_for(shape):
    stepping = {"transfer": "apic", "scheme": "usl"}
    sim = Simulation(disc(stepping=stepping, shape__method=shape, bodies__solid__angular_velocity=2.0))
    sim.advance(1)
    gradient = sim.state.particles.velocity_gradient
    spin = np.broadcast_to([[0.0, -2.0], [2.0, 0.0]], gradient.shape)
    np.testing.assert_allclose(gradient, spin, atol=1e-7)


def held_block():
    """A block at rest on a plane under gravity that leans by 20°, faces off the grid lines."""
    points, held = ("0.5 cells", "stiff", "fitted"), [{"side": "bottom", "fixed": True}]
    bodies = {
        "block": solid([0.57, 0.537], [1.32, 0.912], *points),
        "plane": solid([0.07, 0.0], [2.07, 0.537], *points, sides=held),
    }
    return scene_of(
        *(bodies, 0.25, [-1.0, -1.0], [3.0, 3.0]),
        end=3.2,
        outputs=4,
        contact={"method": "penalty", "friction": 0.5, "penalty": {"kappa": 1.0}},
        materials={"stiff": STIFF},
        gravity={"vector": [3.420201433, -9.396926208]},
        settle={"tolerance": 3e-4},
        output={"particles": False, "surface": False},
    )


def test_a_body_at_rest_stays_for_five_thousand_steps():
    """It moves in the first 10³ steps, as far as settling has left it, and rests since."""
    series = mpmfw.run(held_block())["series"].to_dataset()
    place = series["centre_of_mass"].sel(body="block").values / 0.25
    way = np.linalg.norm(place - place[0], axis=1)
    assert way.max() < 1e-6
    assert np.ptp(way[2:]) < 1e-7


@pytest.mark.filterwarnings("ignore:settling stopped")
@pytest.mark.parametrize(("max_time", "warned"), [(None, False), (5e-3, True)])
def test_a_scene_that_still_moves_at_its_first_output_warns(max_time, warned):
    quarter_period = {"end": 5e-3, "output_interval": 5e-3}
    sim = Simulation(
        column(gravity={"vector": [0.0, -G]}, settle={"max_time": max_time}, time=quarter_period)
    )
    sim.run()
    assert any("still moved" in text for text in sim.concerns()) == warned
    assert (sim._settled["settle_residual"] > 1e-3) == warned
    assert sim.status == "ok"
