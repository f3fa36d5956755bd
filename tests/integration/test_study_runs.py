"""Studies of a scene of milliseconds: results, costs, failures, executors, what is kept and taken up
again.
"""

import shutil

import numpy as np
import pytest
import xarray as xr

import mpmfw
from command_line import called
from mpmfw.campaigns.executors import InProcess
from mpmfw.errors import SceneError
from mpmfw.scene.toml_text import toml_text
from mpmfw.state.fields import STEP_STAGES
from mpmfw.studies.study import relative_error
from studies_for_tests import SLIDING, tiny_study

SAME = ("error", "value", "expected", "status", "steps", "material_points")


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A folder with ``tiny.nc``, a finished study."""
    folder = tmp_path_factory.mktemp("study")
    mpmfw.study(tiny_study(), output=folder / "tiny.nc", jobs=1)
    return folder


@pytest.fixture
def folder(finished, tmp_path):
    """A copy of it."""
    return shutil.copytree(finished, tmp_path / "copy")


def events_of(study, output, **arguments):
    events = []
    dataset = mpmfw.study(study, output=output, progress=events.append, **{"jobs": 1, **arguments})
    return dataset, events


def assert_same(a, b):
    for name in SAME:
        xr.testing.assert_equal(a[name], b[name])


def test_a_study_has_error_cost_and_front_over_what_varies(folder):
    dataset = mpmfw.open(folder / "tiny.nc")
    assert dataset["error"].dims == ("contact", "cell_size")
    assert dataset["shape"].item() == "cpdi"
    assert dataset["pareto"].dtype == bool
    assert dataset["pareto"].any()
    assert set(dataset["status"].values.ravel()) == {"ok"}
    assert dataset["stage_time"].dims == ("contact", "cell_size", "stage")
    np.testing.assert_allclose(dataset["stage_time"].sum("stage"), dataset["cpu_time"])
    assert dataset["cpu_time_spread"].isnull().all()
    assert dataset.attrs["timing"].startswith("exclusive")
    relative = np.abs(dataset["value"] / dataset["expected"] - 1.0)
    np.testing.assert_allclose(dataset["error"], relative)


def test_repeats_add_costs_alone(folder):
    study = tiny_study(vary={"contact": ["penalty"], "cell_size": [0.2, 0.1]}, cost={"repeats": 3})
    files = sorted(path.name for path in (folder / "tiny.nc.runs").iterdir())
    dataset, events = events_of(study, folder / "tiny.nc")
    assert events[-1].total == 4
    assert (dataset["repeats"] == 3).all()
    assert (dataset["cpu_time_spread"] >= 0.0).all()
    assert sorted(path.name for path in (folder / "tiny.nc.runs").iterdir()) == files
    assert "notes" not in dataset.attrs  # every repeat gave the same bits


def test_combinations_that_differ_in_nothing_are_one_run(tmp_path):
    study = tiny_study(vary={"contact": ["separate", "penalty"], "kappa": [0.5, 1.0]})
    dataset, events = events_of(study, tmp_path / "s.nc")
    assert events[-1].total == 3
    assert dataset["error"].sel(contact="separate").notnull().values.tolist() == [True, False]
    said = "refused: kappa 1.0 changes nothing here: it is the run of separate, kappa 0.5"
    assert dataset["status"].sel(contact="separate", kappa=1.0).item() == said


def test_an_error_is_asked_for_in_one_way_everywhere():
    for given in (0.01, "0.01", "1%", "1 %"):
        assert relative_error(given) == 0.01
    for given in (1, "1", 5.0):
        with pytest.raises(SceneError, match=r"is an error of \d00 %; expected"):
            relative_error(given)
    with pytest.raises(SceneError, match="expected a relative error"):
        relative_error("little")


def test_a_run_that_fails_is_a_result(tmp_path):
    # The grid ends below the block, which falls out of it without contact
    scene = {**SLIDING, "time": {"end": 0.6, "output_interval": 0.05}}
    study = tiny_study(scene=scene, vary={"contact": ["separate", "penalty"]}, cost={"repeats": 2})
    dataset, events = events_of(study, tmp_path / "s.nc")
    failed = dataset.sel(contact="separate")
    assert failed["status"].item().startswith("failed: ")
    assert np.isnan(failed["error"])
    assert not failed["pareto"]
    assert dataset.sel(contact="penalty")["status"].item() == "ok"
    assert events[-1].done == events[-1].total == 3  # it is not repeated
    assert events_of(study, tmp_path / "s.nc")[1][-1].total == 0


@pytest.mark.filterwarnings("ignore:.*settling stopped")
@pytest.mark.parametrize("counts", [False, True])
def test_settling_is_told_by_stage_and_counts_if_asked_for(tmp_path, counts):
    settle = {"tolerance": 0.05, "max_time": 0.2, "gravity": {"magnitude": 10, "tilt": 0}}
    cost = {"repeats": 1, "settling": counts}
    vary = {"contact": ["separate", "penalty"]}
    study = tiny_study(scene={**SLIDING, "settle": settle}, vary=vary, cost=cost)
    dataset, _ = events_of(study, tmp_path / "s.nc")
    steps, settled = dataset["stage_time"], dataset["settle_stage_time"]
    assert steps.dims == settled.dims == ("contact", "stage")
    assert list(steps["stage"].values) == list(STEP_STAGES)
    assert (settled.sel(contact="penalty") > 0.0).all()
    assert settled.sel(contact="separate", stage="contact").item() == 0.0
    bare = dataset["steps"] - counts * dataset["settle_steps"]
    assert (dataset["settle_steps"] > 50).all()
    assert ((bare > 0) & (bare < dataset["settle_steps"])).all()
    assert bool((dataset["cpu_time"] > dataset["settle_time"]).all()) == counts
    assert ("of settling" in steps.attrs["long_name"]) == counts


def test_an_interrupted_study_continues_from_the_runs_that_it_has(tmp_path):
    def stop(event):
        if event.done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mpmfw.study(tiny_study(), output=tmp_path / "s.nc", jobs=1, progress=stop)
    dataset, events = events_of(tiny_study(), tmp_path / "s.nc")
    assert events[-1].total == 2
    assert_same(dataset, mpmfw.study(tiny_study(), jobs=1))


def test_requests_that_make_no_sense_are_refused(tmp_path):
    for arguments, message in (
        ({"jobs": 0}, "jobs: must be at least 1"),
        ({"repeats": 0}, "repeats: must be at least 1"),
        ({"under": 0.0}, "under: must be greater"),
        ({"timing": "alone"}, "timing: 'alone' is unknown"),
        ({"jobs": 2, "executor": "tcp://127.0.0.1:1"}, "no effect with an executor"),
    ):
        with pytest.raises(SceneError, match=message):
            mpmfw.study(tiny_study(), output=tmp_path / "s.nc", **arguments)
    assert InProcess.timing == "exclusive"


# -- the command


def test_the_command_prints_a_table_and_a_sentence_and_its_figures_are_drawn(tmp_path):
    (tmp_path / "s.toml").write_text(toml_text(tiny_study()), encoding="utf-8")
    output = tmp_path / "out.nc"
    done = called("study", tmp_path / "s.toml", "-o", output, "--jobs", 1, "--under", "5000%")
    assert "The cheapest combination under 5e+03 % error is" in done.output
    assert done.output.count("\n") < 25
    assert "settle" not in done.output  # nothing settles
    called("plot", output)
    assert (tmp_path / "out-front.png").stat().st_size > 10_000
    assert (tmp_path / "out-stages.png").stat().st_size > 10_000
