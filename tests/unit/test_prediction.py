"""The cost model: steps exactly where the limit does not change, times from the table, and a table of one's own."""

import json
import math

import pytest

from contact_scenes import impact
from mpmfw import cost_table
from mpmfw.clock import STEP_STAGES
from mpmfw.cost_table import measured_costs
from mpmfw.prediction import predict
from mpmfw.scene import load_scene
from mpmfw.simulation import Simulation


@pytest.fixture
def table(tmp_path, monkeypatch):
    """A table of round numbers as this user's own: 1 µs a step and 1 ns an entity in every stage."""
    path = tmp_path / "costs.json"
    line = [1e-6, 1e-9, 0.0]
    costs = {
        "shape": {"cpdi": dict.fromkeys(STEP_STAGES, line)},
        "contact": {"penalty": line},
        "effect": {name: [0.0, 0.0, 0.0] for name in cost_table.EFFECTS},
        "frame": {"series": [1e-3, 0.0, 0.0], "points": [1e-2, 0.0, 0.0]},
        "start": [1.0, 0.0, 0.0],
    }
    path.write_text(json.dumps(costs))
    monkeypatch.setattr(cost_table, "own_table", lambda: path)
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
    assert found.output_time == pytest.approx(11 * 1e-3)  # frames at 0, 0.01 … 0.1 s, without points
    assert found.start_time == 1.0
    assert found.settle_steps == 0
    assert "--measure" in found.source
    assert found.unknown == ()


def test_what_was_not_measured_is_named(table):
    costs = json.loads(table.read_text())
    costs["contact"]["bardenhagen"] = costs["contact"]["penalty"]
    table.write_text(json.dumps(costs))
    assert predict(made(contact="separate", shape="gimp"), []).unknown == ("gimp", "separate")


def test_the_shipped_table_knows_every_bundled_method(tmp_path, monkeypatch):
    monkeypatch.setattr(cost_table, "own_table", lambda: tmp_path / "none.json")
    costs, source = measured_costs()
    assert set(costs["shape"]) >= {"linear", "gimp", "cpdi", "cpdi2", "bspline", "cubic_bspline", "ck"}
    assert set(costs["contact"]) >= {"none", "separate", "bardenhagen", "penalty", "lcp", "nairn"}
    assert set(costs["effect"]) == set(cost_table.EFFECTS)
    assert all(min(line) >= 0.0 for stages in costs["shape"].values() for line in stages.values())
    assert "shipped" in source


@pytest.mark.usefixtures("table")
def test_effects_count_for_what_they_act_on(table):
    costs = json.loads(table.read_text())
    costs["effect"] |= {"gravity": [1e-5, 0.0, 0.0], "sides": [1e-6, 1e-9, 0.0], "ledger": [1e-4, 0.0, 0.0]}
    table.write_text(json.dumps(costs))
    mapping = impact(gap=0.5, speed=0.0, slide=0.0)
    mapping["time"] = {"end": 0.1, "output_interval": 0.01}
    mapping["output"] = {"gap": False, "particles": True, "ledger": True}
    bare = predict(Simulation(mapping), [])
    mapping["gravity"] = {"vector": [0.0, -1.0]}
    mapping["settle"] = {"max_time": 0.02}
    name, body = next(iter(mapping["bodies"].items()))
    body["sides"] = [{"side": "bottom", "fixed": True}, {"side": "left", "fixed": True}]
    simulation = Simulation(mapping)
    found = predict(simulation, [])
    points = next(b.particles.stop - b.particles.start for b in simulation.state.bodies if b.name == name)
    more = found.stages["force"] / found.steps - bare.stages["force"] / bare.steps
    assert more == pytest.approx(1e-5 + 2 * (1e-6 + 1e-9 * points))
    assert found.output_time == pytest.approx(11 * (1e-3 + 1e-2) + found.steps * 1e-4)
    assert found.settle_steps == math.ceil(0.02 / (0.1 / found.steps))


def test_a_measured_table_has_what_the_shipped_one_has(tmp_path, monkeypatch):
    """Few samples of small blocks."""
    for name, value in (("REPEATS", 1), ("STEPS", 20), ("FRAMES", 1), ("SIZES", ((4, 4), (6, 6), (8, 1)))):
        monkeypatch.setattr(cost_table, name, value)
    monkeypatch.setattr(
        cost_table, "available", lambda kind: {"shape": ["cpdi"], "contact": ["penalty"]}[kind]
    )
    cost_table.measure(tmp_path / "costs.json")
    monkeypatch.setattr(cost_table, "own_table", lambda: tmp_path / "none.json")
    shipped, _ = measured_costs()
    found = json.loads((tmp_path / "costs.json").read_text())
    assert set(found) == set(shipped)
    assert set(found["effect"]) == set(shipped["effect"])
    assert set(found["shape"]["cpdi"]) == set(shipped["shape"]["cpdi"])
    assert found["start"][0] > 0.1
