"""Runs that are broken off: what is kept, what is said, and that a file tells whether it is complete."""

from types import SimpleNamespace

import netCDF4
import numpy as np
import pytest
from typer.testing import CliRunner

import mpmfw
from mpmfw.cli import app
from mpmfw.errors import MpmfwError, ResultsWarning
from mpmfw.results import Frame, RunHeader, RunWriter
from mpmfw.results.reading import read
from mpmfw.state.fields import PARTICLE_FIELDS, SERIES_FIELDS
from scenes_for_tests import two_blocks

POSITION, ENERGY = PARTICLE_FIELDS[0], SERIES_FIELDS[5]
HEADER = RunHeader(2, ("a",), (), {"a": 2000}, (POSITION, ENERGY))


def frame(k):
    values = np.random.default_rng(k).random((2000, 2))
    return Frame(0.1 * k, {"position": values}, series={"kinetic_energy": np.full(1, float(k))})


def disk_that_is_full(after):
    """Disk usage as shutil gives it, with no room left after so many questions."""
    free = iter([10**9] * after)
    return lambda _: SimpleNamespace(free=next(free, 0))


def test_a_full_disk_stops_the_run_and_keeps_its_outputs(tmp_path, monkeypatch):
    path = tmp_path / "run.nc"
    monkeypatch.setattr("shutil.disk_usage", disk_that_is_full(after=3))
    monkeypatch.setattr("mpmfw.results.writing.WRITTEN_EVERY", 0.0)
    scene = two_blocks("none", time={"end": 0.01, "output_interval": 0.001}, output={"gap": False})
    with pytest.raises(MpmfwError, match=r"cannot write frame 2 to .*run.nc': No space left on device"):
        mpmfw.run(scene, output=path)
    assert read(path)["series"].sizes["time"] == 2
    assert read(path).attrs["status"].startswith("failed: cannot write frame 2")


def test_no_room_at_the_start_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "run.nc"
    with RunWriter(path, HEADER) as writer:
        writer.write(frame(0))
        writer.finish({})

    monkeypatch.setattr("shutil.disk_usage", disk_that_is_full(after=0))
    with pytest.raises(MpmfwError, match=r"cannot create '.*run.nc': No space left on device$"):
        RunWriter(path, HEADER)
    assert mpmfw.open(path)["series"].sizes["time"] == 1


def test_a_second_writer_is_refused_and_the_first_goes_on(tmp_path):
    path = tmp_path / "run.nc"
    with RunWriter(path, HEADER) as first:
        first.write(frame(0))
        with pytest.raises(
            MpmfwError, match=r"run.nc' is being written by another run; give another name, or wait"
        ):
            RunWriter(path, HEADER)
        with pytest.warns(
            ResultsWarning, match=r"run.nc is still being written; it holds 1 outputs, the last at 0 s"
        ):
            mpmfw.open(path)
        first.write(frame(1))
        first.finish({})
    assert mpmfw.open(path)["series"].sizes["time"] == 2
    with RunWriter(path, HEADER) as again:  # afterwards it may be replaced
        again.finish({})
    assert mpmfw.open(path)["series"].sizes["time"] == 0


@pytest.mark.filterwarnings("default::mpmfw.errors.ResultsWarning")
def test_a_file_that_was_broken_off_says_so_at_a_glance(tmp_path):
    path = tmp_path / "run.nc"
    writer = RunWriter(path, HEADER)
    writer.write(frame(0))
    writer.close()  # as a kill leaves it
    with pytest.warns(
        ResultsWarning, match=r"run.nc was broken off: its run did not come to its end; it holds 1 outputs"
    ):
        mpmfw.open(path)
    mpmfw.run(two_blocks("none", output={"gap": False}), output=path)
    with netCDF4.Dataset(path, "a") as dataset:
        dataset.setncattr("status", "running")
    for arguments in (
        ["plot", str(path), "--series", "kinetic_energy"],
        ["plot", str(path), "--field", "von_mises"],
    ):
        said = CliRunner().invoke(app, [*arguments, "--force", "-o", str(tmp_path / "a.png")])
        assert said.exit_code == 0
        assert said.stderr.count("note: ") == 1
        assert "run.nc was broken off: its run did not come to its end" in said.stderr


def test_a_file_that_was_cut_short_is_named(tmp_path):
    path = tmp_path / "run.nc"
    with RunWriter(path, HEADER) as writer:
        for k in range(5):
            writer.write(frame(k))
        writer.finish({})
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(MpmfwError, match=r"cannot read '.*run.nc': the file was cut short or is damaged"):
        mpmfw.open(path)
    said = CliRunner().invoke(app, ["plot", str(path)])
    assert (said.exit_code, "was cut short" in said.stderr) == (2, True)
