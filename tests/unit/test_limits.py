"""Memory, steps and frames are known from the scene's numbers, and refused where they cannot be meant."""

import copy
import tracemalloc

import pytest

import mpmfw
from mpmfw.errors import SceneError
from mpmfw.runs import limits
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from scenes_for_tests import SOFT, scene_of

BODY = {"material": "soft", "particles": {"size": 0.25}}
BODY |= {"geometry": {"type": "disc", "centre": [0, 0], "radius": 1}}
SLOW = {**SOFT, "bulk_modulus": 1e6, "shear_modulus": 1e6}
TABLES = {"shape": {"method": "linear"}, "materials": {"soft": SLOW}}
DISC = scene_of({"a": BODY}, 0.5, [-3, -3], [3, 3], end=0.01, **TABLES)
PLATE = {"type": "rectangle", "lower": [-1, -1], "upper": [1, 1]}


def refusal(**overrides):
    with pytest.raises(SceneError) as caught:
        mpmfw.run(DISC, set=overrides)
    return str(caught.value)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"bodies.a.geometry.radius": 400}, "bodies.a: the body from (-400, -400) to (400, 400) m is"),
        ({"bodies.a.geometry.radius": 4e6, "grid.lower": [-1e7, -1e7], "grid.upper": [1e7, 1e7]},
         "bodies.a.particles.size: the body 'a' of 8e+06 by 8e+06 m has up to 1.02e+15 material points"),
        ({"grid.cell_size": 1e-8}, "grid.cell_size: the body 'a' of 2 by 2 m has up to 4e+16 nodes"),
        ({"bodies.a.particles.size": 1e-9}, "bodies.a.particles.size: the body 'a' of 2 by 2 m has up to"),
        ({"title": "\ud800"}, "title: has the character '\\ud800', which is not valid Unicode"),
        ({"time.step": 1e-50}, "time.end: 0.01 s in steps of 1e-50 s, set by time.step, takes 1e+48 steps"),
        ({"materials.soft.bulk_modulus": 1e30}, "time.end: 0.01 s in steps of 7.91e-15 s, set by bulk wave"),
    ],
)  # fmt: skip
def test_a_misplaced_power_of_ten_is_named(overrides, message):
    tracemalloc.start()
    try:
        assert message in refusal(**overrides)
        assert tracemalloc.get_traced_memory()[1] < 50e6
    finally:
        tracemalloc.stop()


def test_a_ball_without_volume_within_rounding_is_refused():
    ball = {"material": "soft", "particles": {"size": 0.4}}
    ball["geometry"] = {"type": "ball", "centre": [0.03, 0.04, 0.05], "radius": 6e-7}
    with pytest.raises(SceneError, match=r"bodies\.a: its volume is within rounding of zero"):
        Simulation(scene_of({"a": ball}, 0.5, [-2] * 3, [2] * 3, end=0.001, **TABLES))


def test_nodes_that_32_bits_cannot_count_are_refused_whatever_the_memory(monkeypatch):
    monkeypatch.setattr(limits, "_memory_limits", lambda: iter([1e18]))
    assert "nodes round the bodies are more than 2147483647" in refusal(**{"grid.cell_size": 1e-5})


@pytest.mark.parametrize("name", ["colliding-rings", "rolling-sphere-slip", "sliding-block"])
def test_the_estimate_covers_what_is_allocated(name):
    scene = load_scene(name)
    tracemalloc.start()
    try:
        simulation = Simulation(scene)
        allocated = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    state, sizes = (
        simulation.state,
        [limits.largest_counts(body, scene.grid.cell_size) for body in scene.bodies.values()],
    )
    for body, size in zip(state.bodies, sizes, strict=True):
        own = state.surface.of(body.index)
        assert body.particles.stop - body.particles.start <= size[0]
        assert own.stop - own.start <= size[2]
    assert allocated <= limits.most_memory(scene)


def test_a_forced_run_begins_whatever_its_length(monkeypatch):
    monkeypatch.setattr("mpmfw.runs.limits.MOST_STEPS", 1)
    assert "takes 4 steps, more than 1" in refusal(**{"time.end": 0.02, "time.step": 0.005})
    tree = mpmfw.run(DISC, set={"time.end": 0.02, "time.step": 0.005}, force=True)
    assert tree.attrs["status"] == "ok"
    compared = mpmfw.compare(
        DISC, ["none"], ["linear"], force=True, set={"time.end": 0.02, "time.step": 0.005}
    )
    assert compared.status.item() == "ok"


@pytest.mark.parametrize(("size", "said"), [(2.5, "the body of"), (0.11, "a cell of 0.1 m"), (0.1, "")])
def test_points_larger_than_a_cell_or_their_body_are_noted(size, said):
    plate = {**DISC["bodies"]["a"], "geometry": PLATE, "particles": {"size": size}}
    scene = load_scene({**DISC, "bodies": {"a": plate}}, set={"grid.cell_size": 0.1})
    assert [said in text for text in limits.coarse_bodies(scene)] == [True] * bool(said)


def test_a_run_takes_a_step_at_least_from_output_to_output():
    scene = load_scene(DISC, set={"time.end": 1e-3, "time.output_interval": 1e-13})
    assert limits.steps_of(scene, 1e-3) == limits.outputs_of(scene)


def _plate(**sides):
    scene = copy.deepcopy(DISC)
    scene["bodies"]["a"]["geometry"] = PLATE
    scene["bodies"]["a"]["sides"] = [{"side": side, **value} for side, value in sides.items()]
    return scene


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        (_plate(left={"fixed": True}, bottom={"velocity": [1.0, 0.0]}), "with which it shares a corner"),
        (_plate(left={"velocity": [300.0, "free"]}, right={"fixed": True}), "at 0.006667 s, before time.end"),
        (_plate(left={"velocity": [1.0, "free"]}, right={"velocity": [-1.0, "free"]}), ""),
    ],
)
def test_sides_that_contradict_each_other_are_refused(scene, said):
    if not said:
        load_scene(scene)
        return
    with pytest.raises(SceneError, match=rf"bodies\.a\.sides\[1\]: .*{said}"):
        load_scene(scene)
