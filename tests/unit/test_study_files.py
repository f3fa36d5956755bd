"""A study's file: its keys, its mistakes, its scenes and what makes two runs the same."""

import functools
import math

import numpy as np
import pytest

from mpmfw.api import About
from mpmfw.api.results import Exact, Measure
from mpmfw.campaigns.keys import is_numerical, is_own_method, overrides_of
from mpmfw.campaigns.measures import MEASURES, exact_of, measure_of
from mpmfw.errors import SceneError
from mpmfw.plugin.discovery import available
from mpmfw.results.references import KNOWN, declared
from mpmfw.scene import load_scene
from mpmfw.scene.loading import shipped_scenes
from mpmfw.studies.loading import shipped_studies
from studies_for_tests import SLIDING, judge_of

# -- keys


def test_short_names_stand_for_keys_of_every_body():
    scene = load_scene(SLIDING)
    assert overrides_of(scene.bodies, scene.dim, "safety", 0.3) == {"time.safety": 0.3}
    assert overrides_of(scene.bodies, scene.dim, "segment", "1 cell") == {
        "bodies.block.segment": "1 cell",
        "bodies.plane.segment": "1 cell",
    }
    assert set(overrides_of(scene.bodies, scene.dim, "particles_per_cell", 4).values()) == {"0.5 cells"}
    with pytest.raises(SceneError, match="expected a positive number"):
        overrides_of(scene.bodies, scene.dim, "particles_per_cell", 0)


# -- files

GOOD = """\
scene = "sliding-block"

[vary]
contact = ["none", "penalty"]
cell_size = [0.2, 0.1]

[error]
quantity = "acceleration"
"""


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("contact =", "contacts =", 4, "did you mean 'contact'"),
        ('"none", ', '"non", ', 4, "did you mean 'none'"),
        ("[0.2, 0.1]", "[0.2, -0.1]", 5, "must be greater than 0"),
        ("[0.2, 0.1]", "[0.2, 0.2]", 5, "0.2 is given twice"),
        ("cell_size =", '"bodies.blok.segment" =', 5, "did you mean 'block'"),
        ('quantity = "acceleration"', "", 7, "quantity: missing"),
        ("[error]", "[error]\nfile = 'a.csv'", 8, "has no effect"),
        ("[error]", "[error]\nkind = 'finest'\nfinest = { shape = 'cpdi' }", 9, "is not varied"),
        ("[error]", "[error]\nnorm = 'l2'", 8, "is a number"),
        ('"acceleration"', '"impulse"', 1, "kind = 'finest'"),
        ("[error]", "[cost]\nrepeats = 0\n[error]", 8, "must be at least 1"),
        ("[error]", "[set]\ncell_size = 0.3\n[error]", 8, "replaces it"),
        ("[vary]", "[vary", 3, "not valid TOML"),
    ],
)
def test_a_mistake_is_one_message_with_its_line(tmp_path, old, new, line, message):
    assert old in GOOD
    path = tmp_path / "s.toml"
    path.write_text(GOOD.replace(old, new), encoding="utf-8")
    with pytest.raises(SceneError) as error:
        judge_of(path)
    text = str(error.value)
    assert len(text.splitlines()) == 1
    assert text.startswith(f"{path}:{line}:") or "kind = 'finest'" in message
    assert message in text


def test_shipped_studies_are_valid_and_their_scenes_have_the_error_that_they_ask_for(monkeypatch):
    installed = functools.cache(available)  # they do not change, and are looked up for every scene
    monkeypatch.setattr("mpmfw.plugin.discovery.available", installed)
    assert "sliding-block" in shipped_studies()
    for name in shipped_studies():
        judge, grid = judge_of(name)
        assert judge.exact
        assert all(one.scene is not None for one in grid.combinations.values())


# -- what is known of scenes


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"contact.friction": 0.9}, "the friction holds the block"),
        ({"bodies.block.velocity": [1.0, 0.0]}, "'block' moves at the start"),
        ({"bodies.plane.geometry.angle": 0.1}, "expected one rectangle or box along the axes"),
        ({"loads.pull": {"model": "body_force", "bodies": ["block"], "force": [1, 0]}}, "'block' has loads"),
        ({"gravity": {"vector": [-1.0, -9.0]}}, r"expected gravity towards \+x and -y"),
        ({"gravity": {"table": [[0.0, 5.0, -8.0], [1.0, 5.0, -9.0]]}}, "expected constant gravity"),
        (
            {"bodies.block.geometry": {"type": "rectangle", "lower": [0.1, 0.013], "upper": [0.2, 0.9]}},
            "the block tips over",
        ),
    ],
)
def test_a_closed_form_that_does_not_apply_is_refused_with_the_reason(change, reason):
    with pytest.raises(SceneError, match=f"reference.kind: 'sliding-block' does not apply: {reason}"):
        declared(load_scene("sliding-block", set=change))


def test_a_declared_kind_matters_to_the_measures_that_it_knows():
    """Others have the value that they give, also where the kind does not apply."""
    heavy = load_scene("sliding-block", set={"contact.friction": 0.9})
    doubled = type("Doubled", (Measure,), {"name": "doubled", "exact": lambda *_: Exact.number(2.0, "two")})()
    for scene in (heavy, load_scene("sliding-block")):
        assert exact_of(measure_of("penetration"), scene, About()) is None
        assert exact_of(doubled, scene, About()).at(np.zeros(1)) == [2.0]
    with pytest.raises(SceneError, match="the friction holds the block"):
        exact_of(measure_of("end-displacement"), heavy, About())


def test_measures_known_to_declared_kinds_are_listed():
    scenes = [each for each in map(load_scene, shipped_scenes()) if declared(each) is not None]
    given = {
        name for one in map(declared, scenes) for name in MEASURES if one.exact(name, About()) is not None
    }
    assert given == KNOWN


@pytest.mark.parametrize("key", ["force", "torque", "held", "inertia"])
def test_a_rigid_body_that_more_than_gravity_moves_has_no_closed_form(key):
    rigid = {"force": {"force": [1.0, 0.0]}, "torque": {"torque": 1.0}, "held": {"held": ["rotation"]}}
    rigid = {"density": 1e3, **rigid.get(key, {})} if key != "inertia" else {"mass": 1.0, "inertia": 9.0}
    geometry = {"type": "disc", "centre": [4.0, 2.4], "radius": 1.6}
    changes = {"bodies.cylinder": {"geometry": geometry, "rigid": rigid}}
    with pytest.raises(SceneError, match=f"'cylinder' has {key}"):
        declared(load_scene("rolling-cylinder-slip", set=changes))


def test_gravity_as_a_vector_and_another_order_of_bodies_keep_the_closed_form():
    scene = load_scene("sliding-block")
    mapping = scene.to_mapping()
    mapping["gravity"] = {"vector": list(scene.gravity.at(0.0))}
    mapping["bodies"] = dict(reversed(mapping["bodies"].items()))
    found, before = declared(load_scene(mapping)), declared(scene)
    assert found.body == before.body
    tilt = math.atan2(*np.abs(scene.gravity.at(0.0)))
    friction = scene.pairs[0][2] if scene.pairs else scene.contact.friction
    exact = 10.0 * (math.sin(tilt) - friction * math.cos(tilt))
    assert before.solution.acceleration == pytest.approx(exact, rel=1e-12)
    assert found.solution.acceleration == pytest.approx(before.solution.acceleration, rel=1e-12)


def test_averaged_volume_is_a_method_of_mpmfw_alone():
    assert is_numerical("bodies.block.volumetric")
    assert is_own_method("bodies.block.volumetric")
