"""A file that names ``module:Class`` imports nothing without trust."""

import sys
from pathlib import Path

import pytest
import xarray as xr
from test_resume import stopped

import mpmfw
from command_line import called
from mpmfw.errors import SceneError
from mpmfw.results.domains import corners_of
from mpmfw.results.references import RollingReference, reference_of
from mpmfw.scene import load_scene, shipped_scenes
from mpmfw.scene.toml_text import toml_text
from mpmfw.studies.loading import load_study
from mpmfw.studies.study import make_grid
from scenes_for_tests import two_blocks

#: Keys of a scene that name plug-ins.
PLACES = {
    "shape": {"method": "evil:X"},
    "contact": {"method": "evil:X(a = 1)"},
    "contact.parts": {"detection": "nodes", "law": "evil:X"},
    "contact.friction_law": {"method": "penalty", "friction": 0.1, "friction_law": "evil:X"},
    "contact.joined": {"method": "nodes+evil:X"},
    "materials": {"soft": {"model": "evil:X", "density": 1.0}},
    "loads": {"a": {"model": "evil:X"}},
    "boundaries": {"a": {"model": "evil:X"}},
    "outputs": {"a": {"model": "evil:X"}},
    "bodies": {"a": {"geometry": {"type": "evil:X"}}},
    "reference": {"kind": "evil:X"},
}

STUDY = {
    "scene": "rolling-cylinder-slip",
    "vary": {"contact": ["none"]},
    "error": {"quantity": "displacement"},
}


@pytest.fixture(autouse=True)
def evil(tmp_path, monkeypatch):
    """A module in the working folder that says when it is imported, and is a contact that works."""
    monkeypatch.chdir(tmp_path)
    Path("evil.py").write_text("from faulty_plugins.contact.plain import PlainContact as X\n")
    yield tmp_path
    sys.modules.pop("evil", None)


def written(content, name="t.toml"):
    """The name of a file with these tables."""
    Path(name).write_text(content if isinstance(content, str) else toml_text(content))
    return name


def refused(call, *arguments, **others):
    with pytest.raises(SceneError, match=r"evil:X.*--trust \(Python: trust=True\)"):
        call(*arguments, **others)
    assert "evil" not in sys.modules


@pytest.mark.parametrize("key", PLACES)
def test_a_scene_s_file_imports_nothing(key):
    scene = written({**two_blocks("penalty"), key.partition(".")[0]: PLACES[key]})
    refused(load_scene, scene)
    called("explain", scene, status=2)
    assert "evil" not in sys.modules


def test_other_text_with_a_colon_is_taken():
    load_scene(written("title = 'Impact:Fast'\n" + toml_text(two_blocks("penalty"))))


def test_with_trust_it_does_and_what_is_given_beside_the_file_needs_none():
    scene = {**two_blocks("penalty"), "contact": {"method": "evil:X", "friction": 0.0}}
    assert load_scene(written(scene), trust=True).contact.method == "evil:X"
    sys.modules.pop("evil")
    assert load_scene(scene).contact.method == "evil:X"
    sys.modules.pop("evil")
    plain = written(two_blocks("penalty"), "plain.toml")
    assert load_scene(plain, set={"contact.method": "evil:X"}).contact.method == "evil:X"
    for arguments in ([written(scene), "--trust"], [plain, "--contact", "evil:X"]):
        sys.modules.pop("evil", None)
        called("explain", *arguments)
        assert "evil" in sys.modules


@pytest.mark.parametrize(
    "table",
    [
        {"vary": {"contact": ["penalty", "evil:X(a=1)"]}},
        {"vary": {"contact": ['"\\u0065vil:X"']}},  # a study's texts are read as TOML values
        {"vary": {"shape": ["{ method = 'evil:X' }"]}},
        {"set": {"contact.friction_law": "evil:X"}},
        {"error": {"quantity": "evil:X"}},
        {"scene": {**two_blocks("penalty"), "shape": {"method": "evil:X"}}},
    ],
)
def test_a_study_s_file_imports_nothing(table):
    study = {**STUDY, **table}
    path = written(study)
    with pytest.raises(SceneError, match="--trust"):
        mpmfw.study(path)
    called("study", path, status=2)
    assert "evil" not in sys.modules


def test_a_study_is_trusted_with_its_scene():
    contact = {"method": "evil:X", "friction": 0.0}
    written({**two_blocks("penalty"), "contact": contact}, "scene.toml")
    path = written({**STUDY, "scene": "scene.toml", "vary": {"shape": ["linear"]}})
    load_study(path)
    refused(mpmfw.study, path)
    make_grid(load_study(path, trust=True))
    assert "evil" in sys.modules


def test_a_run_goes_on_with_a_stranger_s_code_only_with_trust(tmp_path):
    scene = {
        **two_blocks("penalty", time__end=0.01, time__output_interval=0.005),
        "contact": {"method": "evil:X", "friction": 0.0},
    }
    stopped(scene, tmp_path / "run.nc", 3)
    sys.modules.pop("evil")
    refused(mpmfw.resume, tmp_path / "run.nc")
    called("resume", "run.nc", status=2)
    assert "evil" not in sys.modules
    called("resume", "run.nc", "--trust")
    assert mpmfw.open(tmp_path / "run.nc").attrs["status"] == "ok"


def test_results_import_nothing_when_they_are_looked_at():
    scene = load_scene("rolling-cylinder-slip").to_mapping()
    expected = reference_of({"scene": shipped_scenes()["rolling-cylinder-slip"]})
    assert isinstance(expected, RollingReference)
    scene["contact"]["method"] = scene["shape"]["method"] = "evil:X"
    for table in scene["materials"].values():
        table["model"] = "evil:X"
    assert reference_of({"scene": toml_text(scene)}) == expected  # no method changes it
    scene["bodies"]["cylinder"]["geometry"] = {"type": "evil:X"}
    point = {name: (("particle", "axis"), [[1.0, 2.0]]) for name in ("position", "deformation_gradient")}
    points = xr.Dataset({**point, "mass": ("particle", [1.0])})
    root = xr.Dataset(attrs={"scene": toml_text(scene), "shape": "cpdi"})
    tree = xr.DataTree.from_dict({"/": root, "/particles/cylinder": points})
    assert reference_of(tree.attrs) is None
    assert corners_of(tree, "cylinder") is None
    assert "evil" not in sys.modules
