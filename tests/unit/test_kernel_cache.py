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


def test_a_kernel_is_found_again(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    np.testing.assert_array_equal(kernel(double)(np.arange(3.0)), [0.0, 2.0, 4.0])
    again = kernel(double)
    again(np.arange(3.0))
    assert sum(again.stats.cache_hits.values()) == 1
