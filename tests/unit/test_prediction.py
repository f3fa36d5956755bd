"""The prediction of a run: its first step, its number of steps, and its cost, from a trial."""

import math

import pytest

from command_line import called
from contact_scenes import impact
from mpmfw.api import hookimpl
from mpmfw.runs import prediction
from mpmfw.runs.prediction import TIMED, WARM_UP, driven_speed, predict, share_of_springs
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw.scene.toml_text import toml_text
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


J2 = {"model": "j2", "density": 1000, "youngs_modulus": 1e6, "poissons_ratio": 0.3, "yield_stress": 1e4}


def test_plastic_flow_has_a_trial_by_itself():
    """All points flow in it, though none does in the first steps; bodies that cannot flow have none."""
    mapping = impact(gap=0.5, speed=0.0, slide=0.0)
    metal = Simulation({**mapping, "materials": dict.fromkeys(mapping["materials"], J2)}, contact="penalty")
    assert predict(metal, []).flow_time >= 0.0  # 0 where other processes took the elastic steps' time
    assert metal.state.arrays["j2/plastic_strain"].min() > 1.0
    assert predict(made(), []).flow_time is None


class Watch:
    """Notes the plastic strain before every update of the stress."""

    name = "watch"

    def __init__(self, simulation):
        self.strain, self.seen = simulation.state.arrays["j2/plastic_strain"], []

    @hookimpl
    def update_stress(self):
        self.seen.append(self.strain.sum())


def test_flow_is_compared_with_steps_in_which_nothing_flows():
    """Though the first steps of this scene flow, and its stress would fall on while it stands still."""
    mapping = impact(gap=0.0, speed=4.0, slide=0.0)
    metal = J2 | {"yield_stress": 10.0, "rate_factor": 1.0}
    made = Simulation({**mapping, "materials": dict.fromkeys(mapping["materials"], metal)}, contact="penalty")
    watch = Watch(made)
    with made.extra_plugin(watch):
        predict(made, [])
    trial = WARM_UP + TIMED
    own, still, sheared = watch.seen[: -2 * trial], watch.seen[-2 * trial : -trial], watch.seen[-trial:]
    assert max(own) > 0.0
    assert still == [0.0] * trial
    assert sheared[-1] > 1.0


def test_explain_says_that_material_may_flow_whatever_the_clock_found(monkeypatch, tmp_path):
    mapping = impact(gap=0.5, speed=0.0, slide=0.0)
    path = tmp_path / "metal.toml"
    path.write_text(toml_text({**mapping, "materials": dict.fromkeys(mapping["materials"], J2)}))
    monkeypatch.setattr(prediction, "_time_of_flow", lambda *_: 0.0)
    assert "material may flow, at a cost too small" in called("explain", path).stdout


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
