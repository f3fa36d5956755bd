"""The prediction of a run: its first step, its number of steps, and its cost, from a trial."""

import math

import pytest

from contact_scenes import impact
from mpmfw.runs.prediction import TIMED, driven_speed, predict, share_of_springs
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.state.fields import STEP_STAGES
from scenes_for_tests import scene_of, solid


def made(contact="penalty", shape="cpdi", **tables):
    mapping = impact(gap=0.5, speed=0.0, slide=0.0)
    mapping["contact"]["method"] = contact
    mapping["time"] = {"end": 0.1, "output_interval": 0.01}
    mapping["output"] = {"gap": False, "particles": False}
    return Simulation({**mapping, **tables}, shape=shape)


def first_step_of(simulation):
    """Length of the first step that a run takes, of settling if it settles."""
    lengths = []

    def stop():
        lengths.append(simulation.state.dt)
        raise StopIteration

    with pytest.raises(StopIteration):
        simulation.run(after_step=stop)
    return lengths[0]


@pytest.mark.parametrize(
    "make",
    [
        lambda: made(),
        lambda: Simulation(impact(gap=0.0, speed=2.0, slide=1.0), contact="penalty"),
        lambda: Simulation(load_scene("sliding-block"), contact="penalty", shape="gimp"),
    ],
    ids=["exact", "moving", "settling"],
)
def test_the_first_step_is_that_of_the_run(make):
    assert predict(make(), []).first_step == first_step_of(make())


def test_the_prediction_holds_all_stages_and_the_most_that_settling_takes():
    gravity = {"vector": [0.0, -1.0]}
    simulation = made(gravity=gravity, settle={"max_time": 0.02}, output={"ledger": True})
    found = predict(simulation, [1000])
    assert set(found.stages) == set(STEP_STAGES)
    assert all(found.stages[stage] > 0.0 for stage in ("shape", "projection", "force", "gather", "material"))
    assert found.cpu_time == pytest.approx(sum(found.stages.values()))
    assert found.settle_steps == math.ceil(0.02 / simulation.stable_step())
    assert found.memory > 1000
    assert found.output_time > 0.0
    assert found.start_time > 0.0


@pytest.mark.parametrize(("interval", "frames"), [(2.5, TIMED // 3 + 2), (100.5, 2)])
def test_outputs_come_between_steps_as_in_the_run(monkeypatch, interval, frames):
    """After every third step, or after none; the first begins the ledger, and the last is timed by itself."""
    step = predict(made(), []).first_step
    simulation, taken = made(time={"end": 301.5 * step, "output_interval": interval * step}), []
    frame = simulation.frame
    monkeypatch.setattr(simulation, "frame", lambda: taken.append(simulation.state.steps) or frame())
    predict(simulation, [])
    assert len(taken) == frames
    assert taken[0] == 1


CELL = 0.1


def pressed(contact, **options):
    """A block on another one of four times its modulus, whose top is driven down."""
    materials = {
        name: {"model": "linear_elastic", "density": 1000, "youngs_modulus": young, "poissons_ratio": 0.0}
        for name, young in (("soft", 1e6), ("firm", 4e6))
    }
    driven = [{"side": "top", "velocity": ["free", -0.01]}]
    bodies = {
        "firm": solid([0.0, -1.0], [1.0, 0.0], 0.05, "firm"),
        "soft": solid([0.0, 0.0], [1.0, 0.5], 0.05, sides=driven),
    }
    tables = {"contact": {"method": contact, **options}, "materials": materials}
    return Simulation(scene_of(bodies, CELL, [-1.0, -2.0], [2.0, 2.0], end=0.01, **tables))


SOFT = {"penalty": {"kappa": 1.0}}


@pytest.mark.parametrize(
    ("contact", "options", "kappa"), [("penalty", {}, 4.0), ("penalty", SOFT, 1.0), ("adhesion", {}, 4.0)]
)
def test_springs_and_bodies_are_in_series(contact, options, kappa):
    """h / (κ M) of the softer body's modulus beside L / M of both, along the motion alone."""
    simulation = pressed(contact, **options)
    springs, bodies = CELL / (kappa * 1e6), 0.5 / 1e6 + 1.0 / 4e6
    assert driven_speed(simulation).tolist() == [0.0, 0.01]
    assert share_of_springs(simulation, 1) == pytest.approx(springs / (springs + bodies), rel=1e-12)
    assert share_of_springs(simulation, 0) == 0.0  # the blocks do not press on each other along x
