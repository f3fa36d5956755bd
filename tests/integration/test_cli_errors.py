"""Bad requests: status 2 and one message on stderr, with where, which key and the nearest name."""

# Messages are compared whole, and stand on one line as they are printed

import re
import subprocess
import sys

import pytest

from command_line import called
from drop_for_tests import drop_scene
from mpmfw.scene.toml_text import toml_text

SCENE = toml_text(drop_scene("linear", "none"))


@pytest.fixture
def refused(tmp_path, monkeypatch):
    """Return the messages for an ``s.toml`` with replacements that the command line refuses."""
    monkeypatch.chdir(tmp_path)

    def refused(*arguments, replace=("", "")):
        (tmp_path / "s.toml").write_text(SCENE.replace(*replace))
        result = called(*arguments, status=2)
        assert result.stdout == ""
        return result.stderr

    return refused


@pytest.mark.parametrize("command", ["run", "compare", "explain"])
def test_a_bad_scene_is_status_2_and_one_message(refused, command):
    said = r"s\.toml:\d+: bodies\.upper\.geometry\.raduis: unknown key; did you mean 'radius'\?\n"
    assert re.fullmatch(said, refused(command, "s.toml", replace=("radius", "raduis")))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["run", "s.toml", "--set", "grid.cel_size=1"],
            "--set grid.cel_size: unknown key; did you mean 'cell_size'?\n",
        ),
        (["run", "s.toml", "--set", "time.end=1", "--set", "time.end=2"], "--set time.end: given twice"),
        (["run", "s.toml", "-o", "no/such/out.nc"], "no/such/out.nc: the folder no/such does not exist\n"),
        (["compare", "s.toml", "--contact", "none,none"], "--contact none,none: a name is given twice\n"),
        (["compare", "s.toml", "--contact", "none,penlty"], "--contact penlty: no such contact plug-in; did"),
        (
            ["run", "s.toml", "--shape", "gimp", "--set", "shape.method=cpdi"],
            "--shape gimp: --set shape.method",
        ),
        (["plot", "s.toml"], "s.toml: does not hold results"),
        (["run", "s.toml", "-o", "./s.toml"], "s.toml: has no results of kind 'run'"),
        (["compare", "s.toml", "-o", "c.nc", "--report", "c.nc"], "--report c.nc: is the file of --output"),
        (["compare", "s.toml", "--set", "contact.method=none"], "--set contact.method: the methods of a"),
        (
            ["compare", "s.toml", "--vary", "time.end=1,2", "--set", "time.end=1"],
            "--set time.end: --vary time.end",
        ),
        (["compare", "s.toml", "--vary", "time.end=1,1"], "--vary time.end: 1 is given twice"),
        (["run", "s.toml", "--set", "contact.penalty.kappa=2"], "--set contact.penalty.kappa: has no effect"),
        (["benchmark", "--scenes", ","], "--scenes: expected at least one scene"),
        (["compare", "s.toml", "--format", "xml"], "Usage: "),
    ],
)
def test_a_bad_argument_is_status_2(refused, arguments, message):
    assert refused(*arguments).startswith(message)


def test_neither_import_nor_help_costs_a_heavy_import():
    heavy = ["numba", "xarray", "matplotlib", "pint", "numpy", "rich", "mpmfw.plugin.discovery"]
    code = f"""
import sys
import mpmfw
from contextlib import suppress
def loaded(*more):
    print("#", [name for name in (*{heavy}, *more) if name in sys.modules])
loaded("typer", "pydantic", "mpmfw.errors")
from mpmfw.cli import main
for arguments, more in ((["--help"], ["pydantic"]), (["compare", "--help"], [])):  # its options need pydantic
    with suppress(SystemExit):
        main(arguments)
    loaded(*more)
import mpmfw_testing.templates  # of mpmfw new
print("#", [name for name in ("numba", "pytest") if name in sys.modules])
"""
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert [line for line in found.stdout.splitlines() if line.startswith("#")] == ["# []"] * 4
