"""``mpmfw check``: what it refuses, what it finds, what it prints."""

from __future__ import annotations

import subprocess
import sys

from typer.testing import CliRunner

from mpmfw.cli import app


def test_the_command_finds_a_law_in_the_working_directory(tmp_path):
    (tmp_path / "my_law.py").write_text(
        "from mpmfw.api import ContactStrategy\n\n\nclass MyLaw(ContactStrategy):\n    name = 'mine'\n"
    )
    command = "import sys; from mpmfw.cli import app; sys.path.remove(''); app()"
    asked = ["check", "my_law:MyLaw", "--only", "options"]
    done = subprocess.run(
        [sys.executable, "-c", command, *asked], cwd=tmp_path, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "the plug-in has no options" in done.stdout


def test_the_command_runs_checks_and_tells_of_failures(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["check", "separate", "--only", "pushes-apart", "--only", "options"])
    assert done.exit_code == 1
    for part in (
        "pushes-apart",
        "not applicable",
        "smallest counterexample",
        "mpmfw-check/separate-pushes-apart.png",
    ):
        assert part in done.stdout
    assert "1 of 2 checks went wrong: pushes-apart" in done.stderr
    assert (tmp_path / "mpmfw-check" / "separate-pushes-apart.png").is_file()

    (tmp_path / "why.toml").write_text(
        '[expected_failures]\npushes-apart = "no interaction: bodies pass through"\n'
    )
    chosen = ["--only", "pushes-apart", "--expected-failures", "why.toml", "--pictures", "shown"]
    done = CliRunner().invoke(app, ["check", "separate", *chosen])
    assert done.exit_code == 0
    assert "expected failure" in done.stdout
    assert "no interaction: bodies pass through" in done.stdout
