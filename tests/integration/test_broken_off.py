"""Runs that are broken off: what is kept, what is said, and that a file tells whether it is complete."""

import signal
import threading
from types import SimpleNamespace

import netCDF4
import numpy as np
import pytest

import mpmfw
from command_line import called
from mpmfw.errors import Interrupted, MpmfwError, ResultsWarning
from mpmfw.results import Frame, RunHeader, RunWriter
from mpmfw.results.reading import read
from mpmfw.runs.interruption import interruptible, unbroken
from mpmfw.state.fields import PARTICLE_FIELDS, SERIES_FIELDS
from scenes_for_tests import two_blocks

POSITION, ENERGY = PARTICLE_FIELDS[0], SERIES_FIELDS[5]
HEADER = RunHeader(2, ("a",), (), {"a": 2000}, (POSITION, ENERGY))


def frame(k):
    values = np.random.default_rng(k).random((2000, 2))
    return Frame(0.1 * k, {"position": values}, series={"kinetic_energy": np.full(1, float(k))})


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.nc"


def full_disk(monkeypatch, after):
    """No room is left after so many questions."""
    free = iter([10**9] * after)
    monkeypatch.setattr("shutil.disk_usage", lambda _: SimpleNamespace(free=next(free, 0)))


def test_a_full_disk_stops_the_run_and_keeps_its_outputs(path, monkeypatch):
    full_disk(monkeypatch, after=3)
    monkeypatch.setattr("mpmfw.results.writing.WRITTEN_EVERY", 0.0)
    scene = two_blocks("none", time={"end": 0.01, "output_interval": 0.001}, output={"gap": False})
    with pytest.raises(MpmfwError, match=r"cannot write frame 2 to .*run.nc': No space left on device"):
        mpmfw.run(scene, output=path)
    assert read(path)["series"].sizes["time"] == 2
    assert read(path).attrs["status"].startswith("failed: cannot write frame 2")


def test_a_signal_before_a_failed_write_still_interrupts(path, monkeypatch):
    real = RunWriter.finish

    def finish(*_):
        signal.raise_signal(signal.SIGTERM)
        monkeypatch.setattr(RunWriter, "finish", real)
        raise OSError("the disk is gone")

    monkeypatch.setattr(RunWriter, "finish", finish)
    scene = two_blocks("none", time={"end": 0.001, "output_interval": 0.001}, output={"gap": False})
    with pytest.raises(Interrupted, match="interrupted; the run had failed: the disk is gone") as caught:
        mpmfw.run(scene, output=path)
    assert caught.value.number == signal.SIGTERM


def test_no_room_at_the_start_leaves_the_old_file(path, monkeypatch):
    with RunWriter(path, HEADER) as writer:
        writer.write(frame(0))
        writer.finish({})
    full_disk(monkeypatch, after=0)
    with pytest.raises(MpmfwError, match=r"cannot create '.*run.nc': No space left on device$"):
        RunWriter(path, HEADER)
    assert mpmfw.open(path)["series"].sizes["time"] == 1


def test_a_second_writer_is_refused_and_the_first_goes_on(path):
    with RunWriter(path, HEADER) as first:
        first.write(frame(0))
        with pytest.raises(MpmfwError, match=r"run.nc' is being written by another run"):
            RunWriter(path, HEADER)
        with pytest.warns(ResultsWarning, match=r"run.nc is still being written; it holds 1 outputs"):
            mpmfw.open(path)
        first.write(frame(1))
        first.finish({})
    assert mpmfw.open(path)["series"].sizes["time"] == 2
    with RunWriter(path, HEADER) as again:  # afterwards it may be replaced
        again.finish({})
    assert mpmfw.open(path)["series"].sizes["time"] == 0


@pytest.mark.filterwarnings("default::mpmfw.errors.ResultsWarning")
def test_a_file_that_was_broken_off_says_so_at_a_glance(path):
    writer = RunWriter(path, HEADER)
    writer.write(frame(0))
    writer.close()  # as a kill leaves it
    with pytest.warns(ResultsWarning, match=r"run.nc was broken off: .*; it holds 1 outputs"):
        mpmfw.open(path)
    mpmfw.run(two_blocks("none", output={"gap": False}), output=path)
    with netCDF4.Dataset(path, "a") as dataset:
        dataset.setncattr("status", "running")
    drawn = path.with_name("a.png")
    said = called("plot", path, "--field", "von_mises", "-o", drawn)
    assert said.stderr.count("note: ") == 1
    assert "run.nc was broken off: its run did not come to its end" in said.stderr


def test_a_signal_takes_effect_after_what_must_be_whole():
    done = []
    with interruptible():
        if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
            pytest.skip("the host takes signals itself")
        with pytest.raises(Interrupted) as stopped, unbroken():  # noqa: PT012
            signal.raise_signal(signal.SIGTERM)
            signal.raise_signal(signal.SIGTERM)
            done.append("whole")
        assert (done, stopped.value.number) == (["whole"], signal.SIGTERM)
        with unbroken():
            done.append("again")
        with pytest.raises(Interrupted):
            signal.raise_signal(signal.SIGTERM)


def test_an_error_within_is_its_own_and_another_thread_takes_no_signals():
    with pytest.raises(ValueError, match="mine"), unbroken():
        raise ValueError("mine")
    done = []

    def work():
        with unbroken():
            done.append(signal.getsignal(signal.SIGINT))

    before = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert done == [before] == [signal.getsignal(signal.SIGINT)]
