"""A study on a Dask cluster, by its address, as an object, or by a client."""

from concurrent.futures import ThreadPoolExecutor

import pytest
import xarray as xr

import mpmfw
from mpmfw.campaigns.executors import Futures
from mpmfw.errors import MpmfwError, SceneError
from studies_for_tests import tiny_study

distributed = pytest.importorskip("distributed")
pytestmark = [
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


def test_a_scheduler_that_does_not_answer_is_said(monkeypatch):
    monkeypatch.setattr("mpmfw.campaigns.executors.PATIENCE", 0.2)
    with pytest.raises(SceneError, match="no scheduler answers at this address"):
        mpmfw.study(tiny_study(), executor="tcp://127.0.0.1:1")


@pytest.mark.parametrize("address", ["foo", "tcp://127.0.0.1"])
def test_a_text_that_is_no_address_is_said_at_once(address):
    with pytest.raises(SceneError, match="expected an address such as tcp"):
        mpmfw.study(tiny_study(), executor=address)


def test_a_run_whose_worker_was_killed_is_one_that_died():
    errors = {"a": distributed.scheduler.KilledWorker("a", None, 3), "c": ValueError("it broke")}

    def work(task):
        if task in errors:
            raise errors[task]
        return task

    executor = Futures(lambda: ThreadPoolExecutor(1), "workers")
    assert dict(executor.outcomes(work, ["a", "b"])) == {"a": None, "b": "b"}
    with pytest.raises(MpmfwError, match="a run was dropped: it broke"):
        list(executor.outcomes(work, ["c"]))


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_addresses_clients_and_clusters_are_executors():
    study = tiny_study(vary={"contact": ["separate", "penalty"]})
    here = mpmfw.study(study, jobs=1)
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "silence_logs": 50}
    with distributed.LocalCluster(**options, processes=False, protocol="tcp://") as cluster:
        by_address = mpmfw.study(study, executor=cluster.scheduler_address)
        by_cluster = mpmfw.study(study, executor=cluster)
        with distributed.Client(cluster, set_as_default=False) as client:
            by_client = mpmfw.study(study, executor=client)
            assert client.status == "running"  # it is the caller's
    for dataset in (by_address, by_cluster, by_client):
        xr.testing.assert_equal(dataset["error"], here["error"])
        assert dataset.attrs["cores"] == "2 workers of a Dask cluster"
