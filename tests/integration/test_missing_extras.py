"""A command that needs an extra which is not installed is a wrong request, whichever command it is."""

from __future__ import annotations

import sys

import pytest
from typer.testing import CliRunner

from mpmfw.cli import app
from mpmfw.scene.toml_text import toml_text
from studies_for_tests import SLIDING

SCHEDULER = ["--scheduler", "tcp://127.0.0.1:1"]


@pytest.mark.parametrize(
    ("module", "arguments", "extra"),
    [
        ("hypothesis", ["check", "neo_hookean"], "testing"),
        ("pytest", ["validate", "hertz", "--quick"], "testing"),
        ("distributed", ["compare", "scene.toml", *SCHEDULER], "dask"),
        ("distributed", ["validate", "hertz", "--quick", *SCHEDULER], "dask"),
    ],
)
def test_a_missing_extra_is_named_with_status_2(tmp_path, monkeypatch, module, arguments, extra):
    (tmp_path / "scene.toml").write_text(toml_text(SLIDING), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, module, None)
    done = CliRunner().invoke(app, arguments)
    assert (done.exit_code, f"pip install 'mpmfw[{extra}]'" in done.output) == (2, True), done.output
    assert {path.name for path in tmp_path.iterdir()} <= {"scene.toml", "validation-results"}
