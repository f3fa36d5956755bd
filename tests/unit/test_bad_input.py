"""Requests that are wrong end with one message that says what and where, never with a traceback."""

import pytest
from typer.testing import CliRunner

from mpmfw.cli import app
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene.toml_text import toml_text
from scenes_for_tests import block, one_body


@pytest.fixture
def said(tmp_path, monkeypatch):
    """What a command says that goes wrong, in a folder with a scene."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.toml").write_text(toml_text(block(time__end=1e-4, time__output_interval=1e-4)))

    def invoke(*arguments):
        result = CliRunner().invoke(app, list(arguments))
        assert isinstance(result.exception, SystemExit), result.exception
        assert result.exit_code in (1, 2)
        return result.output

    return invoke


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("run", "s.toml", "-o", "/dev/null"), "/dev/null: is a device or a pipe; give the name of a file\n"),
        (("run", "s.toml", "-o", "a" * 300), f"'{'a' * 300}': File name too long\n"),
        (("new", "load", "zz", "--into", "s.toml"), "'s.toml/mpmfw-zz': Not a directory\n"),
        (("new", "load", "z" * 300), f"'mpmfw-{'z' * 300}': File name too long\n"),
    ],
)
def test_a_file_that_cannot_be_is_named(said, arguments, message):
    assert said(*arguments) == message


@pytest.mark.parametrize(
    "geometry",
    [
        {"type": "disc", "centre": [0, 0], "radius": 1e-8},
        {"type": "polygon", "points": [[0, 0], [1e-59, 0], [0, 1e-59]]},
        {"type": "ball", "centre": [0, 0, 0], "radius": 1e-59},
        {"type": "cylinder", "centre": [0, 0, 0], "radius": 0.5, "length": 1e-59},
        {"type": "torus", "centre": [0, 0, 0], "radius": 0.5, "tube_radius": 1e-30},
    ],
)
def test_a_body_far_below_a_cell_is_refused(geometry):
    with pytest.raises(
        SceneError,
        match=r"bodies\.solid\.geometry: the body is .* m across at its thinnest, less than 1e-06",
    ):
        Simulation(one_body(geometry, size=0.125))
