"""Campaigns of a scene of milliseconds: one dataset, one store, any executor, and what a kill leaves."""

import concurrent.futures
import os
import random
import shutil
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import mpmfw
from command_line import called
from mpmfw.api import hookimpl
from mpmfw.campaigns.store import Store
from mpmfw.cli.compare import print_comparison
from mpmfw.errors import ResultsWarning, SceneError
from mpmfw.plugin.measure import Exact, Reference
from mpmfw.runs.identity import counted, is_current, key_of, sources
from mpmfw.scene import load_scene
from mpmfw_contact.penalty import Penalty
from studies_for_tests import SLIDING

pytestmark = pytest.mark.filterwarnings("default::mpmfw.errors.ResultsWarning")

#: What differs from run to run.
TIMED = ("time", "stage", "repeat", "load", "peak_memory", "wall")


def same(a, b):
    """Check that two datasets hold the same, costs apart."""
    names = [name for name in a.data_vars if not any(word in str(name) for word in TIMED)]
    assert {*names} == {name for name in b.data_vars if not any(word in str(name) for word in TIMED)}
    assert "centre_of_mass" in names
    xr.testing.assert_equal(a[names], b[names])


def counting(events):
    return {"progress": events.append, "repeats": 1}


VARY = {"contact": ["separate", Penalty(kappa=0.5)], "cell_size": [0.2, 0.1]}


@pytest.fixture(scope="module")
def undisturbed():
    return mpmfw.campaign(SLIDING, VARY, repeats=1)


def test_one_dataset_over_what_varies(undisturbed):
    assert undisturbed["centre_of_mass"].dims[:2] == ("contact", "cell_size")
    assert undisturbed["contact"].values.tolist() == ["separate", "penalty(kappa=0.5)"]
    assert (undisturbed["status"] == "ok").all()
    assert undisturbed["cpu_stage"].dims[-1] == "stage"
    assert undisturbed["cpu_time_repeat"].dims[-1] == "repeat"
    assert undisturbed.attrs["timing"].startswith("exclusive")
    assert undisturbed.attrs["cores"] == "one core"
    assert undisturbed.attrs["processor"]


def test_measures_and_their_errors():
    data = mpmfw.campaign(
        SLIDING,
        {"contact": ["separate", "penalty"]},
        measures=["end-displacement", "force-noise", "impulse"],
        repeats=1,
    )
    relative = abs(
        data["end_displacement"] / (0.5 * 10.0 * (np.sin(0.4) - 0.1 * np.cos(0.4)) * 0.02**2) - 1.0
    )
    np.testing.assert_allclose(data["end_displacement_error"], relative)
    assert "Coulomb friction" in data["end_displacement_error"].attrs["against"]
    assert "force_noise" in data
    assert "impulse_error" not in data  # nothing is known to judge it by
    with pytest.raises(SceneError, match="did you mean 'force-noise'"):
        mpmfw.campaign(SLIDING, {"contact": ["penalty"]}, measures=["force-nois"])
    finest = mpmfw.campaign(
        SLIDING, {"cell_size": [0.2, 0.1]}, measures=["displacement"], reference={"kind": "finest"}, repeats=1
    )
    assert np.isfinite(finest["displacement_error"].values).tolist() == [True, False]


class Mine(Reference):
    """The acceleration is 2 m/s²."""

    name = "mine"

    def exact(self, scene, measure, about):  # noqa: ARG002
        is_known = measure == "acceleration"
        return Exact("closed-form", "a law of mine", lambda _: np.array([2.0])) if is_known else None


def test_a_strangers_scene_has_a_strangers_closed_form(announce, capsys):
    """Its error columns come by the command line's way."""
    announce("reference", "mine", f"{__name__}:Mine")
    data = mpmfw.compare({**SLIDING, "reference": {"kind": "mine"}}, ["penalty"], ["cpdi"], repeats=1)
    assert data["acceleration_error"].item() == pytest.approx(abs(data["acceleration"].item() / 2.0 - 1.0))
    assert "end_displacement_error" not in data
    print_comparison(data)
    assert "Errors against a law of mine" in capsys.readouterr().out


def test_a_reference_is_what_the_scene_says_it_is():
    data = mpmfw.compare(SLIDING, ["none"], ["linear"], repeats=1)
    assert "acceleration_error" in data
    without = {key: table for key, table in SLIDING.items() if key != "reference"}
    assert "acceleration_error" not in mpmfw.compare(without, ["none"], ["linear"], repeats=1)
    other = {**SLIDING, "reference": {"kind": "rolling-cylinder"}}
    with pytest.warns(
        ResultsWarning, match="no errors are measured: .* expected one free disc, and the scene has none"
    ):
        data = mpmfw.compare(other, ["none"], ["linear"], repeats=1)
    assert "acceleration_error" not in data
    with pytest.raises(
        SceneError, match=r"reference\.kind: 'slidin-block' is unknown; did you mean 'sliding-block'"
    ):
        load_scene({**SLIDING, "reference": {"kind": "slidin-block"}})


# -- the store


def test_names_and_objects_resume(tmp_path, undisturbed):
    events = []
    mpmfw.campaign(SLIDING, {**VARY, "cell_size": [0.2]}, store=tmp_path, **counting(events))
    assert events[-1].total == 2
    wider = {"contact": [Penalty(kappa=0.5), "separate", Penalty(kappa=2.0)], "cell_size": ["200 mm", 0.1]}
    mpmfw.campaign(SLIDING, wider, store=tmp_path, **counting(events))
    assert events[-1].total == 4
    data = mpmfw.campaign(SLIDING, VARY, store=tmp_path, **counting(events))
    assert events[-1].total == 0
    same(data, undisturbed)


def test_a_key_is_the_meaning_of_the_scene():
    scene = load_scene(SLIDING)
    key = key_of(scene)
    for same_meaning in (
        {"grid.cell_size": "200 mm"},
        {"time.end": "20 ms"},
        {"time.safety": 0.5},
        {"contact.penalty.kappa": type(scene.contact.options)().kappa},
        {"title": "another"},
        {"contact.bardenhagen.criterion": "position"},
    ):
        assert key_of(load_scene(SLIDING, set=same_meaning)) == key, same_meaning
    for other in ({"grid.cell_size": 0.1}, {"contact.penalty.kappa": 0.3}, {"contact.method": "none"}):
        assert key_of(load_scene(SLIDING, set=other)) != key
    assert key_of(scene, contact=Penalty(kappa=2.0)) == key_of(scene, contact=Penalty(kappa=2.0))
    assert key_of(scene, contact=Penalty(kappa=2.0)) != key_of(scene, contact=Penalty(kappa=3.0))


def test_a_key_knows_code_and_libraries(monkeypatch):
    scene = load_scene(SLIDING)
    key = key_of(scene)
    with monkeypatch.context() as patched:
        patched.setattr("mpmfw.runs.identity.package", lambda _: "changed")
        assert key_of(scene) != key
    monkeypatch.setattr("mpmfw.runs.identity.version", lambda _: "99")
    assert key_of(scene) != key


def test_a_comment_leaves_stored_runs_valid_but_where_numbers_are_made(tmp_path):
    package = Path(mpmfw.__file__).parent
    shutil.copytree(package, tmp_path / "mpmfw", ignore=shutil.ignore_patterns("__pycache__"))
    before = sources(counted(tmp_path / "mpmfw"))
    assert before == sources(counted(package))
    elsewhere = ("campaigns/grid.py", "errors.py")
    for name in (*elsewhere, "step/transfer.py", "kernels/particle_grid.py", "codes/outputs.py"):
        file = tmp_path / "mpmfw" / name
        text = file.read_text(encoding="utf-8")
        file.write_text(f"{text}# a comment\n", encoding="utf-8")
        assert (sources(counted(tmp_path / "mpmfw")) == before) == (name in elsewhere), name
        file.write_text(text, encoding="utf-8")


def test_what_is_stored_may_be_read_by_whom_the_umask_lets(tmp_path):
    before = os.umask(0o027)
    try:
        mpmfw.campaign(SLIDING, {"contact": ["separate"]}, store=tmp_path / "runs", repeats=1)
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "runs").stat().st_mode) == 0o750
    assert {stat.S_IMODE(path.stat().st_mode) for path in (tmp_path / "runs").iterdir()} == {0o640}


def test_the_store_forgets_what_no_campaign_would_take(tmp_path, monkeypatch):
    mpmfw.campaign(SLIDING, {"contact": ["separate", "none"]}, store=tmp_path, repeats=1)
    left = tmp_path / f".{'0' * 32}.{'0' * 32}.part.nc"
    left.write_bytes(b"")
    os.utime(left, (0, 0))
    output = called("store", "prune", tmp_path).output
    assert "0 runs deleted" in output
    assert "2 runs kept" in output
    assert not left.exists()
    first, _ = sorted(tmp_path.glob("*.json"))
    code = Store(tmp_path).outcome(first.stem).code
    assert is_current(code)
    monkeypatch.setattr("mpmfw.runs.identity._core", lambda: "another core")
    assert called("store", "prune", tmp_path).output.endswith("0 runs kept\n")
    assert list(tmp_path.iterdir()) == []
    called("store", "prune", tmp_path / "nowhere", status=2)


# -- executors


def test_anybodys_executor_runs_a_campaign(undisturbed):
    with concurrent.futures.ThreadPoolExecutor(2) as threads:
        data = mpmfw.campaign(SLIDING, VARY, executor=threads, repeats=1)
    same(data, undisturbed)
    assert data.attrs["cores"] == "the workers of a ThreadPoolExecutor"
    with pytest.raises(SceneError, match="executor: 3 cannot run tasks; expected"):
        mpmfw.campaign(SLIDING, VARY, executor=3)
    with pytest.raises(SceneError, match="jobs: has no effect with an executor"):
        mpmfw.campaign(SLIDING, VARY, executor=threads, jobs=3)


class Deadly(Penalty):
    """A law that brings down the process that it runs in."""

    name = "deadly"

    @hookimpl
    def add_nodal_force(self):
        os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this platform")
def test_a_run_that_dies_harms_no_other_and_an_object_that_cannot_leave_runs_here():
    """A process gives the same dataset as this one."""

    class Here(Penalty):
        name = "here"

    data = mpmfw.campaign(SLIDING, {"contact": [Deadly(), "penalty", Here()]}, jobs=2, repeats=1)
    died = "failed: its process ended abruptly, perhaps because memory ran out"
    assert data["status"].values.tolist() == [died, "ok", "ok"]
    first, second = (data["centre_of_mass"].sel(contact=name, drop=True) for name in ("penalty", "here"))
    xr.testing.assert_equal(first, second)
    assert data.attrs["timing"] == "shared cores"
    assert data.attrs["cores"].startswith("2 processes on ")


# -- kills

KILLS = int(os.environ.get("MPMFW_KILLS", "2"))
#: Forty points in the long form, else six.
POINTS = {
    "contact": ["separate", "penalty"],
    "safety": [round(0.5 - 0.02 * k, 2) for k in range(20 if KILLS >= 20 else 3)],
}
PROGRAM = """
import sys
import mpmfw
from test_campaign import POINTS, SLIDING
if __name__ == "__main__":
    mpmfw.campaign(SLIDING, POINTS, store="runs", jobs=int(sys.argv[1]), repeats=1)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this platform")
def test_a_campaign_that_is_killed_again_and_again_ends_with_the_same_dataset(tmp_path):
    """The process itself and its workers, at random moments of their work; ``MPMFW_KILLS=20`` is the long
    form.
    """
    (tmp_path / "program.py").write_text(PROGRAM, encoding="utf-8")
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)]),
    }
    chance, runs, count = random.Random(7), tmp_path / "runs", 2 * len(POINTS["safety"])
    kills, starts = [], 0
    while len(kills) < KILLS:
        starts += 1
        command, more = [sys.executable, "program.py", str(1 + starts % 2)], 1
        with subprocess.Popen(command, cwd=tmp_path, env=environment) as process:
            while len(kills) < KILLS and process.pid not in kills:
                before = len(list(runs.glob("[!.]*.json")))
                while len(list(runs.glob("[!.]*.json"))) < before + more and process.poll() is None:
                    time.sleep(0.002)
                time.sleep(chance.uniform(0.0, 0.02))
                assert process.poll() is None, "it came to its end before all kills"
                kills.append(chance.choice([process.pid, *children_of(process.pid)]))
                os.kill(kills[-1], signal.SIGKILL)
                more = chance.choice((0, 0, 1))
            process.kill()
    assert 0 < len(list(runs.glob("[!.]*.json"))) <= count
    data = mpmfw.campaign(SLIDING, POINTS, store=runs, repeats=1)
    assert len(list(runs.glob("[!.]*.json"))) == len(list(runs.glob("[!.]*.nc"))) == count
    same(data, mpmfw.campaign(SLIDING, POINTS, repeats=1))


def children_of(process):
    """Processes that were started by another one (Linux); none elsewhere."""
    listed = Path(f"/proc/{process}/task/{process}/children")
    return [int(pid) for pid in listed.read_text().split()] if listed.exists() else []


def test_ctrl_c_says_what_is_kept_and_how_to_go_on(tmp_path):
    def stop(event):
        if event.done == 2:
            raise KeyboardInterrupt

    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / f".{32 * 'a'}.{32 * 'b'}.part.json").touch()  # a process that was killed left it
    with pytest.raises(KeyboardInterrupt, match=r"runs keeps 2 finished runs; the same campaign continues"):
        mpmfw.campaign(SLIDING, VARY, store=tmp_path / "runs", progress=stop, repeats=1)
    with pytest.raises(KeyboardInterrupt, match="nothing is kept"):
        mpmfw.campaign(SLIDING, VARY, progress=stop, repeats=1)
