"""The classes in the guide to methods of one's own pass the checks of their kinds, as they stand on the
page.
"""

import re
import sys
import tomllib
from pathlib import Path

import pytest

import mpmfw
from mpmfw.scene.toml_text import toml_text
from scenes_for_tests import two_blocks

GUIDE = Path(__file__).resolve().parents[2] / "docs" / "guide"
#: Classes of a page, with a value for each option that has no default; a reference's example is no scene on
#: the page.
PAGES = {
    "write-a-load": {"Wind": {"speed": "30 m/s"}},
    "write-an-output": {"Fastest": {}, "Shaken": {}},
    "write-a-measure": {"TopSpeed": {}},
    "write-a-geometry": {"Ellipse": {"semi_axes": (0.5, 0.25)}},
    "write-a-material": {"StVenantKirchhoff": {"bulk_modulus": 5e6, "shear_modulus": 3e6}},
    "write-a-detection": {"StifferLeads": {}, "Rate": {}},
}


@pytest.fixture
def module(request, tmp_path, monkeypatch):
    """The code of a page as a module, so that its classes can be sent to other processes."""
    page = request.param
    code = re.findall(
        r"^```python\n(.*?)^```", (GUIDE / f"{page}.md").read_text(encoding="utf-8"), re.S | re.M
    )
    name = page.replace("-", "_")
    (tmp_path / f"{name}.py").write_text("\n\n".join(code), encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    yield __import__(name)
    del sys.modules[name]


#: Of contact's checks, which a detection is asked, a few.
FEW = ("runs", "equal-and-opposite", "reports", "saved", "sent")


@pytest.mark.parametrize(("module", "classes"), PAGES.items(), ids=PAGES, indirect=["module"])
def test_classes_of_a_page_pass_their_checks(module, classes):
    for name, options in classes.items():
        only = FEW if name == "StifferLeads" else None
        mpmfw.check_plugin(getattr(module, name)(**options), only=only, pictures=None)


def scene_of(tables):
    """A scene with what a page's table says."""
    scene = two_blocks("penalty", time__end=0.002, time__output_interval=0.001)
    first, *others = scene["bodies"]
    scene["bodies"] = {"block": scene["bodies"][first], **{name: scene["bodies"][name] for name in others}}
    for kind, table in tables.items():
        if kind == "materials":
            scene[kind] = table
            (name,) = table
            scene["bodies"] = {body: {**given, "material": name} for body, given in scene["bodies"].items()}
        elif kind == "bodies":
            (name,) = table
            scene[kind] = {name: {**scene["bodies"]["block"], **table[name]}}
        else:
            scene[kind] = table
    return scene


@pytest.mark.parametrize("module", PAGES, indirect=True)
def test_scenes_of_a_page_run_with_its_classes(module, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (GUIDE / f"{module.__name__.replace('_', '-')}.md").read_text(encoding="utf-8")
    places = {}
    for name, found in vars(module).items():
        called = getattr(found, "name", None) or getattr(found, "model_fields", {}).get("type")
        if isinstance(found, type) and called and found.__module__ == module.__name__:
            places[getattr(called, "default", called)] = f"{module.__name__}:{name}"
    texts = [
        text for text in re.findall(r"^```toml\n(.*?)^```", page, re.S | re.M) if "[reference]" not in text
    ]
    for text in texts:
        for name, place in places.items():
            text = re.sub(rf'"{name}"|(?<=\[contact\.){name}(?=\])', f'"{place}"', text)
        Path("scene.toml").write_text(toml_text(scene_of(tomllib.loads(text))))
        scene = mpmfw.load_scene("scene.toml", trust=True)
        assert any(place in scene.text for place in places.values())
        assert mpmfw.run(scene).attrs["status"] == "ok"
    assert texts or module.__name__ == "write_a_measure"
