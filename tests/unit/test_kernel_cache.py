"""The disk cache of kernels, when several processes fill it at once."""

import os

import numpy as np
import pytest

from mpmfw.kernels import kernel


def double(x):
    return x + x


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """The cache of a kernel that nobody has compiled yet."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    return kernel(double)._cache._cache_file


def test_processes_that_compile_different_signatures_at_once_do_not_swap_code(cache, monkeypatch):
    """numba reads the index, chooses a name, writes the index, writes the code: two processes take turns."""
    codes = {"float": 1, "integer": 2}
    indices = {kind: cache._load_index() for kind in codes}
    for kind, process in codes.items():
        monkeypatch.setattr(os, "getpid", lambda process=process: process)
        indices[kind][kind] = cache._data_name(1)
        cache._save_index(indices[kind])
        cache._save_data(cache._data_name(1), f"code for {kind}")
    for process in (2, 1):  # the code of the first arrives last
        monkeypatch.setattr(os, "getpid", lambda process=process: process)
        cache._save_data(cache._data_name(1), f"code for {list(codes)[process - 1]}")
    for kind in codes:
        assert cache.load(kind) in (None, f"code for {kind}")


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize(
    "damaged",
    [lambda b: b[: len(b) // 2],
     lambda b: b[:-200] + bytes([b[-200] ^ 1]) + b[-199:]],
    ids=["half", "one bit"],
)  # fmt: skip
def test_a_damaged_file_is_discarded_and_written_again(tmp_path, monkeypatch, ending, damaged):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    kernel(double)(np.arange(3.0))
    for file in tmp_path.rglob(f"*.{ending}"):
        file.write_bytes(damaged(file.read_bytes()))
    again = kernel(double)
    np.testing.assert_array_equal(again(np.arange(3.0)), [0.0, 2.0, 4.0])
    assert not sum(again.stats.cache_hits.values())
    third = kernel(double)
    third(np.arange(3.0))
    assert sum(third.stats.cache_hits.values()) == 1


def test_a_disk_that_is_full_costs_the_cache_alone(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    compiled = kernel(double)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    np.testing.assert_array_equal(compiled(np.arange(3.0)), [0.0, 2.0, 4.0])


@pytest.mark.skipif(os.name == "nt", reason="permissions of POSIX")
def test_a_folder_that_others_may_write_to_is_not_used(tmp_path, monkeypatch):
    open_to_all = tmp_path / "open"
    open_to_all.mkdir()
    open_to_all.chmod(0o777)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(open_to_all))
    with pytest.warns(UserWarning, match=r"compiled again in each process: .*anybody may write"):
        files = kernel(double)._cache._cache_file
    assert not files._cache_path.startswith(str(open_to_all))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "new"))
    kernel(double)
    assert (tmp_path / "new").stat().st_mode & 0o777 == 0o700


@pytest.mark.skipif(os.name == "nt", reason="permissions of POSIX")
def test_another_user_s_folder_is_not_used(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "theirs"))
    monkeypatch.setattr(os, "getuid", lambda: (tmp_path.stat().st_uid) + 1)
    with pytest.warns(UserWarning, match="belongs to another user"):
        files = kernel(double)._cache._cache_file
    assert not files._cache_path.startswith(str(tmp_path))
