"""The cost model: steps exactly where the limit does not change, times from the table, and a table of one's own."""

import json
import math

import pytest

from contact_scenes import impact
from mpmfw import prediction
from mpmfw.clock import STEP_STAGES
from mpmfw.prediction import measured_costs, predict
from mpmfw.scene import load_scene
from mpmfw.simulation import Simulation


@pytest.fixture
def table(tmp_path, monkeypatch):
    """A table of round numbers as this user's own: 1 µs a step and 1 ns an entity in every stage."""
    path = tmp_path / "costs.json"
    stages = {stage: [1e-6, 1e-9] for stage in STEP_STAGES}
    path.write_text(json.dumps({"shape": {"cpdi": stages}, "contact": {"penalty": stages}}))
    monkeypatch.setattr(prediction, "own_table", lambda: path)
    return path


def made(contact="penalty", shape="cpdi"):
    mapping = impact(gap=0.5, speed=0.0, slide=0.0)
    mapping["contact"]["method"] = contact
    mapping["time"] = {"end": 0.1, "output_interval": 0.01}
    mapping["output"] = {"gap": False, "particles": False}
    return Simulation(mapping, shape=shape)


def test_steps_are_exact_where_the_limit_stays():
    simulation = made(contact="separate")
    expected = predict(simulation, []).steps
    simulation.run()
    assert simulation.state.steps == expected


def test_steps_count_with_what_contact_finds_where_bodies_touch():
    short = {"time.end": 0.1, "time.output_interval": 0.1}
    simulation = Simulation(load_scene("sliding-block", set=short), shape="cpdi")
    granted = math.ceil(0.1 / simulation.stable_step())
    simulation.run()
    found = predict(Simulation(load_scene("sliding-block", set=short), shape="cpdi"), [])
    assert found.steps == pytest.approx(simulation.state.steps, rel=0.01)
    assert granted > 1.1 * found.steps  # before contact has searched


def test_steps_before_bodies_meet_are_those_that_contact_takes_for_granted():
    simulation = made()
    before = math.ceil(0.01 / simulation.stable_step()) * 10
    assert predict(simulation, []).steps == before


@pytest.mark.usefixtures("table")
def test_times_follow_the_table():
    simulation = made()
    found = predict(simulation, [1000])
    points, nodes = simulation.state.particles.count, simulation.state.surface.count
    assert found.stages["gather"] == pytest.approx(found.steps * (1e-6 + 1e-9 * points))
    assert found.stages["contact"] == pytest.approx(found.steps * (1e-6 + 1e-9 * nodes))
    assert found.cpu_time == pytest.approx(sum(found.stages.values()))
    assert found.memory > 1000
    assert "--measure" in found.source
    assert found.unknown == ()


def test_what_was_not_measured_is_named(table):
    costs = json.loads(table.read_text())
    costs["contact"]["bardenhagen"] = costs["contact"]["penalty"]
    table.write_text(json.dumps(costs))
    assert predict(made(contact="separate", shape="gimp"), []).unknown == ("gimp", "separate")


def test_the_shipped_table_knows_every_bundled_method(tmp_path, monkeypatch):
    monkeypatch.setattr(prediction, "own_table", lambda: tmp_path / "none.json")
    costs, source = measured_costs()
    assert set(costs["shape"]) == {"linear", "gimp", "cpdi", "cpdi2", "bspline"}
    assert set(costs["contact"]) == {"none", "separate", "bardenhagen", "penalty"}
    assert all(slope >= 0.0 for stages in costs["shape"].values() for _, slope in stages.values())
    assert "shipped" in source
