"""The prediction of a run: its first step, its number of steps, and its cost, from a trial."""

import math

import pytest

from contact_scenes import impact
from mpmfw.runs.prediction import TIMED, predict
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.state.fields import STEP_STAGES


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
