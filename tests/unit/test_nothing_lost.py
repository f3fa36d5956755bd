"""Commands replace what they may replace, and leave every other file of the user as it is."""

import errno
import os
from pathlib import Path

import pytest

import mpmfw
from command_line import called
from mpmfw.errors import SceneError
from mpmfw.runs.simulation import Simulation
from mpmfw.scene.toml_text import toml_text
from scenes_for_tests import one_body, two_blocks

MINE = "years of work\n"
NONE = ("--contact", "none", "--shape", "linear")
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
    return called(*arguments, status=status).output


@pytest.mark.parametrize(
    ("command", "target"),
    [
        (("plot", "a.nc"), "a.png"),
        (("animate", "a.nc"), "a.gif"),
        (("export", "a.nc", "-o", "out"), "out/a-points/00001.vtu"),
        (("compare", "s.toml", *NONE, "-o", "c.nc", "--report", "c.html"), "c.html"),
    ],
)
def test_figures_pages_and_exports_are_replaced_by_force_alone(folder, command, target):
    (folder / target).parent.mkdir(parents=True, exist_ok=True)
    (folder / target).touch()  # an empty file is nothing
    said(*command, status=0)
    for mine in ((folder / target).read_bytes(), MINE.encode()):
        (folder / target).write_bytes(mine)
        assert "exists already; give another name, or --force to replace it" in said(*command, status=2)
        assert (folder / target).read_bytes() == mine
    said(*command, "--force", status=0)
    assert (folder / target).read_bytes() != MINE.encode()
    assert not list(folder.rglob(".*"))


def test_a_run_in_python_replaces_no_other_file(folder):
    (folder / "thesis.txt").write_text(MINE)
    with pytest.raises(SceneError, match="has no results of kind 'run', so it is not replaced"):
        mpmfw.run(SCENE, output="thesis.txt")
    assert (folder / "thesis.txt").read_text() == MINE


@pytest.mark.parametrize("force", [(), ("--force",)])
def test_what_is_called_as_a_checkpoint_and_is_none_stays(folder, force):
    mine = folder / "new.nc.checkpoint"
    mine.write_text(MINE)
    output = said("run", "s.toml", "-o", "new.nc", *force, status=2)
    assert output == "new.nc.checkpoint: is not a checkpoint of a run, for new.nc; give another name\n"
    mpmfw.run(SCENE, output="new.nc", checkpoint=float("inf"))
    assert mine.read_text() == MINE


def test_a_checkpoint_without_its_results_is_not_dropped_unasked(folder):
    (folder / "new.nc.checkpoint").write_bytes(bytes(30) + b"mpmfw checkpoint 5, of a run that was killed")
    assert "is the checkpoint of a run whose results are missing" in said(
        "run", "s.toml", "-o", "new.nc", status=2
    )
    said("run", "s.toml", "-o", "new.nc", "--force", status=0)
    assert not (folder / "new.nc.checkpoint").exists()


@pytest.mark.parametrize(
    ("command", "target"),
    [
        (("compare", "s.toml", *NONE, "-o", "c.nc"), "c.nc"),
        (("export", "a.nc", "-o", "out"), "a-points.pvd"),
    ],
)
def test_a_full_disk_is_one_message_and_leaves_nothing(folder, monkeypatch, command, target):
    replace = os.replace

    def full(source, place):
        if Path(place).name == target:
            raise OSError(errno.ENOSPC, "No space left on device")
        replace(source, place)

    monkeypatch.setattr(os, "replace", full)
    output = said(*command, status=1)
    assert f"{target}': No space left on device" in output.splitlines()[-1]
    assert not list(folder.rglob(".*")) + list(folder.rglob(target))


def test_an_empty_folder_beside_results_lets_nothing_be_replaced(folder):
    assert Path.cwd() == folder
    Path("a.nc.runs").mkdir()
    before = os.stat("a.nc").st_mtime_ns
    assert "a.nc: exists already; give another name, or --force" in said(
        "run", "s.toml", "-o", "a.nc", status=2
    )
    assert os.stat("a.nc").st_mtime_ns == before
    command = ("compare", "s.toml", *NONE, "-o", "c.nc")
    said(*command, status=0)
    said(*command, status=0)  # its finished runs lie beside it
    for path in Path("c.nc.runs").iterdir():
        path.unlink()
    assert "c.nc: exists already; give another name, or --force" in said(*command, status=2)
    Path("d.nc.runs").write_text(MINE)
    assert "d.nc.runs: is a file, not a folder of finished runs" in said(*command[:-1], "d.nc", status=2)


@pytest.mark.parametrize(
    "command",
    [("run", "s.toml", "-o", "c.nc", "--checkpoint", "0"), ("compare", "s.toml", *NONE, "-o", "c.nc")],
)
def test_files_that_are_called_as_half_written_ones_stay(folder, command):
    mine = [folder / f"c.nc{ending}" for ending in (".part", ".checkpoint.part", ".checkpoint.results")]
    for one in mine:
        one.write_text(MINE)
    said(*command, status=0)
    assert [one.read_text() for one in mine] == [MINE] * 3
    assert not list(folder.glob(".*"))


def test_links_are_followed_and_loops_are_named(folder):
    (folder / "real").mkdir()
    (folder / "c.nc").symlink_to("real/c.nc")
    said("compare", "s.toml", *NONE, "-o", "c.nc", status=0)
    assert (folder / "c.nc").is_symlink()
    assert (folder / "real/c.nc").is_file()
    (folder / "l.nc").symlink_to("l.nc")
    for command in ("run", "compare"):
        assert said(command, "s.toml", "-o", "l.nc", status=2).startswith(
            "l.nc: is a link that leads to itself"
        )


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        ("run s.toml -o /dev/null", 2, "/dev/null: is a device or a pipe; give the name of a file"),
        (f"run s.toml -o {'a' * 300}", 1, f"'{'a' * 300}': File name too long"),
        ("new load zz --into s.toml", 1, "'s.toml/mpmfw-zz': Not a directory"),
        (f"new load {'z' * 300}", 1, f"'mpmfw-{'z' * 300}': File name too long"),
    ],
)
def test_a_file_that_cannot_be_is_named(folder, arguments, status, message):
    assert (folder / "s.toml").is_file()
    assert said(*arguments.split(), status=status) == f"{message}\n"


@pytest.mark.parametrize(
    "geometry",
    [
        {"type": "disc", "centre": [0, 0], "radius": 1e-8},
        {"type": "cylinder", "centre": [0, 0, 0], "radius": 0.5, "length": 1e-59},
    ],
)
def test_a_body_far_below_a_cell_is_refused(geometry):
    with pytest.raises(
        SceneError,
        match=r"bodies\.solid\.geometry: the body is .* m across at its thinnest, less than 1e-06",
    ):
        Simulation(one_body(geometry, size=0.125))
