"""Devices are compiled for kernels, once for all integers, and for Python where it calls them."""

from __future__ import annotations

import numba
import numpy as np

from mpmfw.kernels import device


@device
def entry(values, k):
    return values[k]


@numba.njit  # no kernel: one from the cache would compile no device
def three_entries(values, short):
    return entry(values, 0) + entry(values, 2) + entry(values, short[0])


def test_a_device_is_compiled_once_for_all_integers():
    values, short = np.array([1.0, 2.0, 4.0]), np.array([1], dtype=np.int32)
    assert three_entries(values, short) == 7.0
    assert len(entry.overloads) == 1


def test_a_device_can_be_called_from_python_before_and_after_kernels_have_it():
    values, short = np.array([1.0, 2.0, 4.0]), np.array([1], dtype=np.int32)
    assert entry(values, 1) == 2.0
    three_entries(values, short)
    assert entry(values, 1) == entry(values, np.int64(1)) == entry(values=values, k=1) == 2.0
