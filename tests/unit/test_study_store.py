"""Finished runs in a folder: whole at every moment, and run again where they are damaged."""

import math
import os
from dataclasses import replace

import numpy as np
import pytest

from mpmfw.campaigns.grid_runs import costs_of, least, over_repeats
from mpmfw.campaigns.running import counted
from mpmfw.campaigns.store import COSTS, Cost, Outcome, Store
from mpmfw.errors import SceneError
from mpmfw.state.fields import STEP_STAGES

COST = Cost("exclusive", {"cpu_time": 1.5}, {"shape": 0.5}, {"shape": 0.1})


def record(key, status="ok"):
    return Outcome(key, status, "a run", "title = 'x'", "", ("a note",), (COST,))


def test_a_record_comes_back_as_it_was(tmp_path):
    Store(tmp_path / "runs").put(record("a"))
    assert Store(tmp_path / "runs").outcome("a") == record("a")
    assert Store(tmp_path / "runs").outcome("b") is None


@pytest.mark.parametrize("damage", ["", "{", '{"key": "a"}', "[]"])
def test_a_damaged_record_is_run_again(tmp_path, damage):
    Store(tmp_path).put(record("a"))
    (tmp_path / "a.json").write_text(damage, encoding="utf-8")
    assert Store(tmp_path).outcome("a") is None


def test_a_record_without_its_results_is_run_again(tmp_path):
    Store(tmp_path).put(replace(record("a"), digest="0123"))
    assert Store(tmp_path).outcome("a") is None


KEYS = [digit * 32 for digit in "0a5"]


def a_store(folder):
    """Two runs, one of today's code, and half of a third that a kill left long ago."""
    for key, code in zip(KEYS, ("old", "new"), strict=False):
        Store(folder).put(replace(record(key), code={"mpmfw": code}))
    half = folder / f".{KEYS[2]}.{KEYS[2]}.part.json"
    half.write_text('{\n "key": ')
    os.utime(half, (0, 0))
    return folder


def is_new(code):
    return code["mpmfw"] == "new"


def test_prune_removes_what_a_store_wrote_and_nothing_else(tmp_path):
    folder, elsewhere = a_store(tmp_path / "runs"), tmp_path / "elsewhere.json"
    elsewhere.write_text((folder / f"{KEYS[0]}.json").read_text())
    foreign = {
        "notes.json": "{}", f"{'b' * 31}.json": '{"key": "another"}', "thesis.nc": "mine",
        f"{'b' * 33}.nc": "mine", "download.part": "half", f".{KEYS[2]}.part.json": "mine",
    }  # fmt: skip
    for name, text in foreign.items():
        (folder / name).write_text(text)
        os.utime(folder / name, (0, 0))
    (folder / "sub.nc").mkdir()
    (folder / f"{KEYS[2]}.json").symlink_to(elsewhere)
    assert Store(folder).prune(is_new)[:2] == (1, 1)
    left = {path.name for path in folder.iterdir()}
    assert left == {*foreign, "sub.nc", f"{KEYS[2]}.json", f"{KEYS[1]}.json"}
    assert elsewhere.exists()


def test_prune_of_another_folder_says_so_and_removes_nothing(tmp_path):
    (tmp_path / "notes.json").write_text("{}")
    with pytest.raises(SceneError, match="holds no finished runs"):
        Store(tmp_path).prune(is_new)
    assert (tmp_path / "notes.json").exists()


def cost(cpu_time, stage, peak_memory=math.nan):
    values = {
        **dict.fromkeys((name for name, _, _ in COSTS), 7.0),
        "cpu_time": cpu_time,
        "peak_memory": peak_memory,
    }
    return Cost(
        "exclusive", values, dict.fromkeys(STEP_STAGES, stage), dict.fromkeys(STEP_STAGES, 0.0), 0.0, ""
    )


def test_the_cost_is_that_of_the_cheapest_repeat_with_its_own_stages():
    each = costs_of({"contact": ["a"]}, {(0,): [cost(3.0, 0.5, 9.0), cost(2.0, 0.25), cost(6.0, 0.1)]})
    one = least(each)
    assert one["cpu_time"].item() == 2.0
    assert (one["stages"] == 0.25).all()
    assert one["peak_memory"].item() == 9.0  # only a process's first run knows it
    assert over_repeats(each)["cpu_time_spread"].item() == 2.0


def test_costs_on_shared_cores_do_not_count_where_exclusive_ones_are_asked_for():
    both = replace(record("a"), costs=(replace(COST, timing="shared cores"), COST))
    assert counted(both, exclusive=True) == [COST]
    assert counted(both, exclusive=False) == list(both.costs)


def test_runs_without_a_cost_have_none():
    one = least(costs_of({"contact": ["a", "b"]}, {(1,): [cost(1.0, 0.1)]}))
    assert np.isnan(one["cpu_time"].values[0])
    assert one["cpu_time"].values[1] == 1.0
    none = costs_of({"contact": ["a"]}, {})
    assert np.isnan(least(none)["cpu_time"]).all()
    assert over_repeats(none)["repeats"].item() == 0
