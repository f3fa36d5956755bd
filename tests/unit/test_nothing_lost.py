"""Commands that write replace what mpmfw wrote itself, and nothing else of the user's."""

import os
from pathlib import Path

import pytest
from typer.testing import CliRunner

import mpmfw
from mpmfw.cli import app
from mpmfw.errors import SceneError
from mpmfw.scene.toml_text import toml_text
from scenes_for_tests import two_blocks

MINE = "years of work\n"
SCENE = two_blocks("none", time__end=2e-4, time__output_interval=1e-4, shape__method="linear")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The file of a small run."""
    path = tmp_path_factory.mktemp("run") / "a.nc"
    mpmfw.run(SCENE, output=path)
    return path.read_bytes()


@pytest.fixture
def folder(tmp_path, monkeypatch, results):
    """A working folder with that file and its scene."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.nc").write_bytes(results)
    (tmp_path / "s.toml").write_text(toml_text(SCENE))
    return tmp_path


def said(*arguments, status):
    found = CliRunner().invoke(app, [str(one) for one in arguments])
    assert found.exit_code == status, found.output
    return found.output


@pytest.mark.parametrize(
    ("command", "target"),
    [
        (("plot", "a.nc"), "a.png"),
        (("plot", "a.nc", "-o", "b.pdf"), "b.pdf"),
        (("plot", "a.nc", "-o", "b.svg"), "b.svg"),
        (("plot", "a.nc", "--field", "von_mises"), "a-von_mises.png"),
        (("plot", "a.nc", "--series", "kinetic_energy"), "a-kinetic_energy.png"),
        (("animate", "a.nc"), "a.gif"),
        (("export", "a.nc", "-o", "out"), "out/a-points.pvd"),
        (("export", "a.nc", "-o", "out"), "out/a-points/00001.vtu"),
        (("export", "a.nc", "-o", "out"), "out/a-series.csv"),
        (("compare", "s.toml", "--shape", "linear", "-o", "c.nc", "--force", "--report", "c.html"), "c.html"),
    ],
)
def test_own_files_are_replaced_and_those_of_others_are_not(folder, command, target):
    said(*command, status=0)
    written = (folder / target).read_bytes()
    said(*command, status=0)
    (folder / target).write_text(MINE)
    output = said(*command, status=2)
    assert f"{target}: is there already and " in output
    assert "not replaced; give another" in output
    assert (folder / target).read_text() == MINE
    (folder / target).write_bytes(written)
    said(*command, status=0)


def test_an_export_of_fewer_outputs_removes_its_own_alone(folder):
    said("export", "a.nc", "-o", "out", status=0)
    mine = folder / "out/a-points/00077.vtu"
    mine.write_text(MINE)
    assert (folder / "out/a-points/00001.vtu").exists()
    said("export", "a.nc", "-o", "out", "--every", 3, status=0)
    assert not (folder / "out/a-points/00001.vtu").exists()
    assert mine.read_text() == MINE


def test_a_run_in_python_replaces_no_other_file(folder):
    (folder / "thesis.txt").write_text(MINE)
    with pytest.raises(SceneError, match="is no run's results, so it is not replaced"):
        mpmfw.run(SCENE, output="thesis.txt")
    assert (folder / "thesis.txt").read_text() == MINE


@pytest.mark.parametrize("force", [(), ("--force",)])
def test_what_is_called_as_a_checkpoint_and_is_none_stays(folder, force):
    mine = folder / "new.nc.checkpoint"
    mine.write_text(MINE)
    output = said("run", "s.toml", "-o", "new.nc", *force, status=2)
    assert (
        output
        == "new.nc.checkpoint: is no checkpoint of a run, and would be replaced by that of new.nc; give another name\n"
    )
    mpmfw.run(SCENE, output="new.nc", checkpoint=float("inf"))
    assert mine.read_text() == MINE


def test_a_checkpoint_without_its_results_is_not_dropped_unasked(folder):
    (folder / "new.nc.checkpoint").write_bytes(b"PK\x03\x04 of a run that was killed")
    assert "is the checkpoint of a run whose results are not there" in said(
        "run", "s.toml", "-o", "new.nc", status=2
    )
    said("run", "s.toml", "-o", "new.nc", "--force", status=0)
    assert not (folder / "new.nc.checkpoint").exists()


def test_an_empty_folder_beside_results_lets_nothing_be_replaced(folder):
    assert Path.cwd() == folder
    Path("a.nc.runs").mkdir()
    before = os.stat("a.nc").st_mtime_ns
    assert "a.nc: is there already; give another name, or --force" in said(
        "run", "s.toml", "-o", "a.nc", status=2
    )
    assert os.stat("a.nc").st_mtime_ns == before
    command = ("compare", "s.toml", "--shape", "linear", "-o", "c.nc")
    said(*command, status=0)
    said(*command, status=0)  # its finished runs lie beside it
    for path in Path("c.nc.runs").iterdir():
        path.unlink()
    assert "c.nc: is there already; give another name, or --force" in said(*command, status=2)
    Path("d.nc.runs").write_text(MINE)
    assert "its finished runs are kept in d.nc.runs, which is a file" in said(*command[:-1], "d.nc", status=2)


@pytest.mark.parametrize(
    ("target", "option"),
    [
        ("out/validation.csv", ("-o", "out")),
        ("out/sliding-block-motion.png", ("-o", "out")),
        ("page.md", ("-o", "out", "--document", "page.md")),
    ],
)
def test_a_validation_takes_the_place_of_no_other_file(folder, target, option):
    (folder / target).parent.mkdir(exist_ok=True)
    (folder / target).write_text(MINE)
    output = said("validate", "sliding-block", "--quick", *option, status=2)
    assert f"{target}: is there already and is no " in output
    assert (folder / target).read_text() == MINE
    assert "is a file; give the name of a folder" in said(
        "validate", "sliding-block", "-o", "s.toml", status=2
    )


def test_a_file_that_is_called_as_a_half_written_one_stays(folder):
    mine = folder / "c.nc.part"
    mine.write_text(MINE)
    said("compare", "s.toml", "--shape", "linear", "-o", "c.nc", status=0)
    assert mine.read_text() == MINE
    assert not list(folder.glob(".c.nc.*"))
