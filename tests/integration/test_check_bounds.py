"""``mpmfw check --bounds`` finds what is written past the end of an array, in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from mpmfw.cli import app

TESTS = Path(__file__).resolve().parents[1]


def test_the_process_gets_the_request_and_its_status_is_the_commands(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[list[str], dict[str, str]]] = []
    statuses: list[int] = []

    def run(command: list[str], env: dict[str, str], **_: object) -> subprocess.CompletedProcess[bytes]:
        asked.append((command, env))
        return subprocess.CompletedProcess(command, statuses.pop(0))

    monkeypatch.setattr(subprocess, "run", run)
    arguments = ["check", "drag", "--bounds", "--set", "rate=2", "--only", "runs", "--kind", "load"]
    for status, expected in ((0, 0), (1, 1), (2, 2), (-11, 1)):
        statuses = [status]
        found = CliRunner().invoke(app, arguments)
        assert found.exit_code == expected
    assert "was ended by SIGSEGV" in found.output
    command, environment = asked[-1]
    assert environment["NUMBA_BOUNDSCHECK"] == "1"
    assert environment["NUMBA_CACHE_DIR"].endswith("-bounds")
    given = command[command.index("check") + 1 :]
    assert given[:3] == ["drag", "--kind", "load"]
    assert "--bounds" not in given
    assert given[-4:] == ["--set", "rate=2", "--only", "runs"]


@pytest.mark.long
def test_a_row_past_the_end_is_an_error_that_points_at_the_kernel(tmp_path: Path) -> None:
    """Without it the check passes, which is why it is needed."""
    command = [
        sys.executable,
        "-m",
        "mpmfw",
        "check",
        "faulty_plugins.load.faults:PastTheEnd",
        "--kind",
        "load",
    ]
    command += ["--only", "runs", "--pictures", str(tmp_path)]
    environment = {**os.environ, "PYTHONPATH": str(TESTS)}
    found = {
        flag: subprocess.run(
            [*command, *flag], capture_output=True, text=True, check=False, env=environment, cwd=tmp_path
        )
        for flag in ((), ("--bounds",))
    }
    assert found[()].returncode == 0, found[()].stdout
    assert found["--bounds",].returncode == 1
    assert "IndexError" in found["--bounds",].stdout
    assert "out of bounds" in found["--bounds",].stdout
    assert "fill(force, len(force) + 1)" in found["--bounds",].stdout
    assert "force[p, 0] = 1.0" in found["--bounds",].stdout, "the line of the access"
