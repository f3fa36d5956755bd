"""Finished runs in a folder: whole at every moment, and run again where they are damaged."""

import json
import multiprocessing
import os
from dataclasses import replace

import pytest

from mpmfw.campaigns.store import Cost, Outcome, Store
from mpmfw.errors import SceneError

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
        "notes.json": "{}", "thesis.nc": "mine", "download.part": "half", f"{KEYS[2]}.txt": "mine",
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


def write_for_ever(folder, mark):
    store = Store(folder)
    for k in range(100_000):
        store.put(Outcome("a", "ok", mark * 20_000, str(k)))


def test_files_are_whole_at_every_moment(tmp_path):
    context = multiprocessing.get_context("spawn")
    writers = [context.Process(target=write_for_ever, args=(tmp_path, mark)) for mark in "xy"]
    for writer in writers:
        writer.start()
    path, seen = tmp_path / "a.json", set()
    try:
        while len(seen) < 40:
            if path.exists():
                found = json.loads(path.read_text(encoding="utf-8"))
                assert found["name"] in ("x" * 20_000, "y" * 20_000)
                seen.add((found["name"][0], found["scene"]))
    finally:
        for writer in writers:
            writer.kill()
            writer.join()
    assert Store(tmp_path).outcome("a") is not None
