"""``mpmfw check --bounds`` finds what is written past the end of an array, in a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from command_line import called

TESTS = Path(__file__).resolve().parents[1]


def test_the_process_gets_the_request_and_its_status_is_the_commands(monkeypatch):
    asked = []
    ended = {}

    def run(command, env, **_):
        asked.append((command, env))
        return subprocess.CompletedProcess(command, ended["status"])

    monkeypatch.setattr(subprocess, "run", run)
    arguments = ["check", "drag", "--bounds", "--set", "rate=2", "--only", "runs", "--kind", "load"]
    for status, expected in ((0, 0), (1, 1), (2, 2), (-11, 1)):
        ended["status"] = status
        found = called(*arguments, status=expected)
    assert "was ended by SIGSEGV" in found.output
    command, environment = asked[-1]
    assert environment["NUMBA_BOUNDSCHECK"] == "1"
    assert environment["NUMBA_CACHE_DIR"].endswith("-bounds")
    given = command[command.index("check") + 1 :]
    assert (given[:3], given[-4:]) == (["drag", "--kind", "load"], ["--set", "rate=2", "--only", "runs"])
    assert "--bounds" not in given


@pytest.mark.long
def test_a_row_past_the_end_is_an_error_that_points_at_the_kernel(tmp_path):
    """Without it the check passes, which is why it is needed."""
    plugin = "faulty_plugins.load.faults:PastTheEnd"
    command = [sys.executable, "-m", "mpmfw", "check", plugin, "--kind", "load", "--only", "runs"]
    asked = {"env": {**os.environ, "PYTHONPATH": str(TESTS)}, "cwd": tmp_path}
    plain, bounds = (
        subprocess.run([*command, *flag], capture_output=True, text=True, check=False, **asked)
        for flag in ((), ("--bounds",))
    )
    assert plain.returncode == 0, plain.stdout
    assert bounds.returncode == 1
    for said in ("IndexError", "out of bounds", "fill(force, len(force) + 1)", "force[p, 0] = 1.0"):
        assert said in bounds.stdout
