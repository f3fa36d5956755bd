"""Errors that are found after a scene was read say where their key was written."""

from __future__ import annotations

from pathlib import Path

import pytest

from mpmfw.errors import SceneError
from mpmfw.scene import Scene, load_scene, located

TEXT = """\
[grid]
cell_size = 0.5
lower = [0, 0]
upper = [4, 4]
[time]
end = 1
output_interval = 1
[shape]
method = "linear"
[materials.rubber]
model = "neo_hookean"
density = 1000
bulk_modulus = 3
shear_modulus = 1
[bodies.disc]
material = "rubber"
geometry = { type = "disc", centre = [2, 2], radius = 1 }
particles = { size = 0.2 }
"""


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Scene:
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(TEXT)
    return load_scene("s.toml", set={"time.step": 1})


@pytest.mark.parametrize(
    ("key", "message", "said"),
    [
        ("bodies.disc", "outside", "s.toml:15: bodies.disc: outside"),
        ("bodies.disc.rotation", "'exact' is not", "s.toml:15: bodies.disc.rotation: 'exact' is not"),
        ("shape.method", "'cpdi2' needs corners", "s.toml:9: shape.method: 'cpdi2' needs corners"),
        ("time.step", "too long", "--set time.step: too long"),
        ("", "grid.lower: wrong", "grid.lower: wrong"),
    ],
)
def test_located(scene: Scene, key: str, message: str, said: str) -> None:
    assert str(located(SceneError(message, key=key), scene)) == said


def test_a_located_error_keeps_its_place(scene: Scene) -> None:
    error = located(SceneError("wrong", key="grid.lower"), scene)
    assert str(located(error, scene)) == str(error) == "s.toml:3: grid.lower: wrong"


def test_a_scene_without_a_file_has_no_place() -> None:
    shipped = load_scene("colliding-rings").to_mapping()
    assert str(located(SceneError("x", key="time.end"), load_scene(shipped))) == "time.end: x"


def test_an_option_that_was_set_is_named_as_set(scene: Scene) -> None:
    assert scene.time.step == 1
    with pytest.raises(
        SceneError, match=r"with --set contact\.penalty\.master: contact\.penalty: 'master' has no effect"
    ):
        load_scene("rolling-cylinder-slip", set={"contact.penalty.master": "plane"})
