"""A run that was killed or interrupted continues from its last checkpoint, with the same results."""

import json
import math
import os
import random
import re
import signal
import time
import warnings
from contextlib import contextmanager
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from test_many_bodies import row_meets_row
from test_restart import COARSE

import mpmfw
from command_line import called
from mpmfw.errors import Interrupted, MpmfwError, ResultsWarning, SceneError, SimulationError
from mpmfw.kernels import integrate_momentum
from mpmfw.results.reading import read
from mpmfw.runs.restart import write_snapshot
from mpmfw.runs.run import resume, seconds_between
from mpmfw.runs.simulation import Simulation
from mpmfw.scene import load_scene
from mpmfw_contact.penalty import Penalty
from mpmfw_shape.linear import Linear
from scenes_for_tests import two_blocks, with_changes

pytestmark = pytest.mark.filterwarnings("ignore::mpmfw.errors.ResultsWarning")  # settling is cut short

#: Kills in all; a hundred in the long form.
KILLS = int(os.environ.get("MPMFW_KILLS", "6"))
#: Attributes that differ from run to run.
TIMES = (
    *("cpu_", "wall_", "settle_time", "settle_cpu_", "gap_time", "output_time", "compile_time"),
    *("peak_memory", "resumed"),
)
BLOCKS = two_blocks("penalty", time__end=0.02, time__output_interval=0.001, output__ledger=True)
SETTLING = load_scene(
    "rolling-cylinder-slip",
    set=COARSE["rolling-cylinder-slip"] | {"settle.max_time": 0.1, "time.end": 0.15},
)


@pytest.fixture(autouse=True)
def _interrupts_are_heard():
    """Give back what a shell takes from commands in the background, which are started to ignore SIGINT."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Results of the blocks that nobody interrupted."""
    path = tmp_path_factory.mktemp("whole") / "run.nc"
    mpmfw.run(BLOCKS, output=path)
    return path


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.nc"


def same_results(path, reference):
    """All variables and attributes but the timings."""
    one, other = read(path), read(reference)
    assert one.groups == other.groups
    for place in one.groups:
        a, b = one[place], other[place]
        assert set(a.variables) == set(b.variables)
        for name in a.variables:
            assert a[name].dtype == b[name].dtype
            assert a[name].attrs == b[name].attrs
            assert np.asarray(a[name].values).tobytes() == np.asarray(b[name].values).tobytes(), (place, name)
    kept = [
        {name: tree.attrs[name] for name in tree.attrs if not name.startswith(TIMES)} for tree in (one, other)
    ]
    assert kept[0] == kept[1]


def names_in(folder):
    return sorted(file.name for file in folder.iterdir())


@contextmanager
def interrupts(after, *numbers):
    """Signals in the middle of a step."""
    steps = 0

    def counted(*arguments):
        nonlocal steps
        steps += 1
        if steps == after:
            for number in numbers:
                os.kill(os.getpid(), number)
        integrate_momentum(*arguments)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mpmfw.step.schemes.integrate_momentum", counted)
        yield


def stopped(scene, path, after, *numbers, **arguments):
    """Return the error of a run that gets signals in the middle of a step."""
    with interrupts(after, *(numbers or (signal.SIGTERM,))), pytest.raises(Interrupted) as caught:
        mpmfw.run(scene, output=path, **arguments)
    return caught.value


def killed(scene, path, rng, again=False):
    """A run in a process of its own that is killed a moment after its first checkpoint; whether it was."""
    child = os.fork()
    if child == 0:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                resume(path) if again else mpmfw.run(scene, output=path, checkpoint=0.03)
        finally:
            os._exit(0)
    file, end = Path(f"{path}.checkpoint"), time.monotonic() + 60.0
    while not file.is_file() and os.waitpid(child, os.WNOHANG) == (0, 0) and time.monotonic() < end:
        time.sleep(0.001)
    time.sleep(rng.random() * 0.15)
    try:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    except (ProcessLookupError, ChildProcessError):
        pass
    try:
        return bool(read(path).attrs["status"] != "ok")
    except MpmfwError as error:  # killed while HDF5 changed its tables
        return "was cut short or is damaged; mpmfw resume" in str(error)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this platform")
def test_a_run_that_is_killed_at_any_moment_ends_as_one_that_is_not(tmp_path):
    reference, rng, kills = tmp_path / "reference.nc", random.Random("kills"), 0
    mpmfw.run(SETTLING, output=reference)
    for k in range(3 * KILLS):
        path = tmp_path / f"{k}.nc"
        if kills < KILLS and killed(SETTLING, path, rng):
            again = Path(f"{path}.checkpoint").is_file() and rng.random() < 0.3
            kills += 1 + (again and killed(SETTLING, path, rng, again=True))
            resume(path)
            same_results(path, reference)
            assert [file.name for file in tmp_path.glob(f"{k}.nc*")] == [f"{k}.nc"]
    assert kills >= KILLS


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_lets_the_step_end_and_leaves_a_checkpoint(path, whole, number):
    error = stopped(BLOCKS, path, 9, number)
    assert error.number == number
    tree = read(path)
    assert tree.attrs["status"] == "interrupted"
    assert f"keeps {tree['series'].sizes['time']} outputs; mpmfw resume" in str(error)
    with pytest.warns(
        ResultsWarning, match=r"is not complete: interrupted; .* mpmfw resume .*run.nc continues it"
    ):
        mpmfw.open(path)
    tree = resume(path)
    same_results(path, whole)
    assert tree.attrs["status"] == "ok"
    (at,) = json.loads(tree.attrs["resumed"])
    assert 0.0 < at < 0.02
    assert names_in(path.parent) == ["run.nc"]


def test_a_second_signal_ends_the_run_within_the_step(path, whole):
    error = stopped(BLOCKS, path, 9, signal.SIGINT, signal.SIGINT)
    assert re.search("run it again for the rest$", str(error))
    assert read(path).attrs["status"] == "interrupted"
    assert names_in(path.parent) == ["run.nc"]
    error = stopped(BLOCKS, path, 9, signal.SIGINT, signal.SIGINT, checkpoint=0.0)  # that of the step before
    assert re.search("mpmfw resume .* continues it$", str(error))
    resume(path)
    same_results(path, whole)


def test_results_that_a_kill_has_made_unreadable_go_on_from_the_checkpoint(path, whole):
    stopped(BLOCKS, path, 9)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(MpmfwError, match=r"was cut short or is damaged; mpmfw resume .*run.nc continues it"):
        mpmfw.open(path)
    resume(path)
    same_results(path, whole)
    assert names_in(path.parent) == ["run.nc"]


#: Blocks that leave the grid.
FAILING = with_changes(
    BLOCKS, time__end=1.0, grid={"cell_size": 0.25, "lower": [-1.25, -1.0], "upper": [1.0, 1.0]}
)


@pytest.mark.parametrize(
    ("scene", "every", "said", "status"),
    [
        (BLOCKS, 0.0, "run.nc is complete$", "ok"),
        (FAILING, math.inf, "^interrupted; the run had failed: ", "failed: "),
    ],
)
def test_a_signal_after_the_last_step_waits_for_the_file(path, monkeypatch, scene, every, said, status):
    end = mpmfw.runs.run._end

    def at_the_end(*arguments):
        os.kill(os.getpid(), signal.SIGTERM)
        return end(*arguments)

    monkeypatch.setattr("mpmfw.runs.run._end", at_the_end)
    with pytest.raises(Interrupted, match=said) as caught:
        mpmfw.run(scene, output=path, checkpoint=every)
    assert caught.value.number == signal.SIGTERM
    assert mpmfw.open(path).attrs["status"].startswith(status)
    assert names_in(path.parent) == ["run.nc"]


def test_pairs_that_come_near_and_frames_of_points_of_their_own(tmp_path, path):
    scene = with_changes(row_meets_row("penalty"), time__outputs="nearest", output__particles=True)
    scene["output"]["particle_interval"] = 5.0 * scene["time"]["output_interval"]
    mpmfw.run(scene, output=tmp_path / "reference.nc")
    steps = int(read(tmp_path / "reference.nc").attrs["steps"])
    stopped(scene, path, steps // 2)
    resume(path)
    same_results(path, tmp_path / "reference.nc")


def test_a_strategy_object_is_given_again(tmp_path, path):
    mpmfw.run(BLOCKS, contact=Penalty(kappa=0.5), output=tmp_path / "reference.nc")
    assert "mpmfw.resume('" in str(stopped(BLOCKS, path, 9, contact=Penalty(kappa=0.5)))
    for other in (None, Penalty()):
        with pytest.raises(SceneError, match=r"^contact: the run had penalty\(kappa=0.5\), found penalty"):
            resume(path, contact=other)
    with pytest.raises(SceneError, match=r"^shape: the run had cpdi, found linear; mpmfw.resume takes"):
        resume(path, contact=Penalty(kappa=0.5), shape=Linear())
    resume(path, contact=Penalty(kappa=0.5))
    same_results(path, tmp_path / "reference.nc")


def test_another_version_is_refused_with_what_differs(path, monkeypatch):
    stopped(BLOCKS, path, 9)
    monkeypatch.setattr("mpmfw.runs.identity.version", lambda _: "99")
    monkeypatch.setattr("mpmfw.runs.identity.package", lambda _: "changed")
    expected = r"other code: mpmfw_contact \(.{8} then, changed now\), .*numpy \(.* then, 99 now\)"
    with pytest.raises(SceneError, match=expected):
        resume(path)
    assert read(path).attrs["status"] == "interrupted"
    assert resume(path, force=True).attrs["status"] == "ok"


def test_what_cannot_go_on_says_why(path):
    file = Path(f"{path}.checkpoint")

    def refused(said):
        before = path.read_bytes() if path.is_file() else b""
        assert re.search(said, called("resume", path, status=2).stderr)
        assert (path.read_bytes() if path.is_file() else b"") == before

    refused("run.nc: there is no such file; expected the results of a run")
    path.write_text("text")
    refused("run.nc: does not hold results")
    path.unlink()
    mpmfw.run(BLOCKS, output=path)
    refused("run.nc: the run is finished; there is nothing to continue")
    stopped(BLOCKS, path, 9)
    whole = file.read_bytes()
    file.unlink()
    refused(r"run.nc: there is no checkpoint beside it \(run.nc.checkpoint\)")
    file.write_bytes(whole[:-1000])
    refused("run.nc.checkpoint' was cut short or is damaged; run it again")
    write_snapshot(str(file), Simulation(BLOCKS).snapshot())
    refused("run.nc.checkpoint: is not a checkpoint of a run")
    stopped(with_changes(BLOCKS, contact__friction=0.1), path, 9)
    file.write_bytes(whole)
    refused("cannot continue from its checkpoint: the file has another scene")
    with netCDF4.Dataset(path, "a") as dataset:
        dataset.setncattr("kind", "study")
    refused("run.nc: holds not a run but results of kind 'study'; give the command that made it again")
    assert names_in(path.parent) == ["run.nc", "run.nc.checkpoint"]


def test_a_new_run_forgets_the_checkpoint_of_the_last(path):
    stopped(BLOCKS, path, 9)
    done = called("run", "rolling-cylinder-slip", "-o", path, status=2)
    assert "run.nc: exists already, from a run that did not end; mpmfw resume" in done.stderr
    with pytest.raises(SimulationError):
        mpmfw.run(FAILING, output=path)
    assert not Path(f"{path}.checkpoint").exists()


def test_a_full_disk_loses_the_checkpoint_and_not_the_run(path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("mpmfw.runs.restart.os.replace", full)
    with pytest.warns(ResultsWarning, match="no checkpoints are written: .*: No space left") as said:
        mpmfw.run(BLOCKS, output=path, checkpoint=0.0)
    assert len([each for each in said if "no checkpoints" in str(each.message)]) == 1
    assert names_in(path.parent) == ["run.nc"]


def test_the_interval_of_checkpoints_is_judged(path, monkeypatch):
    for wrong in (-1.0, math.nan, "5 m"):
        with pytest.raises(SceneError, match=rf"checkpoint {wrong}: expected a time such as 600 or '10 min'"):
            mpmfw.run(BLOCKS, output=path, checkpoint=wrong)
    with pytest.raises(SceneError, match="checkpoint: has no effect on results that are kept in memory"):
        mpmfw.run(BLOCKS, checkpoint=60.0)
    assert [seconds_between(given) for given in ("10 min", "30", "inf", 0)] == [600.0, 30.0, math.inf, 0.0]
    assert "run it again for the rest" in str(stopped(BLOCKS, path, 9, checkpoint=math.inf))
    assert names_in(path.parent) == ["run.nc"]
    monkeypatch.setattr("mpmfw.runs.restart.write_snapshot", lambda *_: pytest.fail("a checkpoint"))
    mpmfw.run(BLOCKS, output=path, force=True)  # is too short for one


def test_the_command_goes_on_where_it_was_interrupted(path, whole):
    scene = path.with_name("scene.toml")
    scene.write_text(load_scene(BLOCKS).text)
    with interrupts(9, signal.SIGINT):
        done = called("run", scene, "-o", path, status=130)
    assert f"mpmfw resume {path} continues it" in done.stderr
    done = called("resume", path)
    assert re.match(rf"{path}: continues at \S+ s of 0.02 s\n", done.stderr)
    assert done.stdout == f"{path}\n"
    same_results(path, whole)


def test_an_interruption_in_settling_says_so(path):
    assert "interrupted in settling, before time zero: " in str(stopped(SETTLING, path, 9))
    assert called("resume", path).stderr.startswith(f"{path}: continues in settling, before time zero\n")
