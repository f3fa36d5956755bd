"""A study on a Dask cluster: a scheduler and two workers, processes of their own, one of which is killed."""

import json
import signal
import subprocess
import sys
import time

import pytest
import xarray as xr

import mpmfw
from mpmfw.errors import SceneError
from studies_for_tests import SLIDING, tiny_study

distributed = pytest.importorskip("distributed")
pytestmark = [
    pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this platform"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


@pytest.fixture
def cluster(tmp_path):
    """The scheduler's address, and the processes of two workers that nobody starts again."""
    file = tmp_path / "scheduler.json"
    local = ["--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(file)]
    run = [sys.executable, "-m"]
    scheduler = subprocess.Popen(
        [*run, "distributed.cli.dask_scheduler", "--port", "0", *local], cwd=tmp_path
    )
    processes = [scheduler]
    try:
        while not file.exists() or not file.read_text(encoding="utf-8").endswith("}"):
            assert scheduler.poll() is None
            time.sleep(0.05)
        options = ["--no-nanny", "--nthreads", "1", *local]
        processes += [
            subprocess.Popen([*run, "distributed.cli.dask_worker", *options], cwd=tmp_path) for _ in "ab"
        ]
        address = json.loads(file.read_text(encoding="utf-8"))["address"]
        with distributed.Client(address, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
        yield address, processes[1:]
    finally:
        for process in processes[::-1]:
            process.kill()
            process.wait()


def test_a_worker_that_is_killed_loses_nothing(cluster, tmp_path):
    address, workers = cluster
    scene = {**SLIDING, "time": {"end": 0.2, "output_interval": 0.02}}
    study = tiny_study(scene=scene, vary={"contact": ["separate", "penalty"], "safety": [0.5, 0.4, 0.3, 0.2]})
    events = []

    def kill_one(event):
        events.append(event)
        if event.done == 1:
            time.sleep(0.3)  # results wait on the worker by now, and die with it
            workers[0].kill()
            time.sleep(0.3)

    dataset = mpmfw.study(study, output=tmp_path / "s.nc", executor=address, progress=kill_one)
    assert workers[0].wait(10) == -signal.SIGKILL
    assert workers[1].poll() is None
    names = [event.name for event in events[1:]]
    assert len(names) == len(set(names)) == 8
    here = mpmfw.study(study, jobs=1)
    for name in ("error", "value", "status", "steps"):
        xr.testing.assert_equal(dataset[name], here[name])
    assert dataset.attrs["timing"] == "shared cores"
    assert (dataset["repeats"] == 1).all()
    assert len(list((tmp_path / "s.nc.runs").glob("*.json"))) == 8


def test_a_scheduler_that_does_not_answer_is_said(monkeypatch):
    monkeypatch.setattr("mpmfw.campaigns.executors.PATIENCE", 0.2)
    with pytest.raises(SceneError, match="no scheduler answers at this address"):
        mpmfw.study(tiny_study(), executor="tcp://127.0.0.1:1")


@pytest.mark.parametrize("address", ["foo", "tcp://127.0.0.1"])
def test_a_text_that_is_no_address_is_said_at_once(address):
    with pytest.raises(SceneError, match="expected an address such as tcp"):
        mpmfw.study(tiny_study(), executor=address)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_client_and_a_cluster_are_executors_as_they_are():
    study = tiny_study(vary={"contact": ["separate", "penalty"]})
    here = mpmfw.study(study, jobs=1)
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 50}
    with distributed.LocalCluster(**options, processes=False) as cluster:
        by_cluster = mpmfw.study(study, executor=cluster)
        with distributed.Client(cluster, set_as_default=False) as client:
            by_client = mpmfw.study(study, executor=client)
            assert client.status == "running"  # it is the caller's
    for dataset in (by_cluster, by_client):
        xr.testing.assert_equal(dataset["error"], here["error"])
        assert dataset.attrs["cores"] == "2 workers of a Dask cluster"
