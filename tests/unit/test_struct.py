"""Structs of arrays as arguments of kernels: numba finds the type by the class."""

import copy
import ctypes
import pickle
import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import numpy as np
import pytest

from mpmfw.kernels import Struct, kernel, struct
from mpmfw.kernels.types import Floats


class Pair(Struct):
    """Two arrays."""

    first: Floats
    second: Floats


@kernel
def total(pair):
    """The sum of both arrays."""
    return pair.first.sum() + pair.second.sum()


LAYOUTS = {
    "contiguous": np.arange(4.0),
    "strided": np.arange(8.0)[::2],
    "integers": np.arange(4),
    "rows": np.arange(8.0).reshape(4, 2),
}


def test_each_layout_has_its_own_type_and_class():
    pairs = [Pair(first=each, second=np.ones(2)) for each in LAYOUTS.values()]
    for _ in range(2):  # compiled, and found
        assert [total(pair) for pair in pairs] == [8.0, 14.0, 8.0, 30.0]
    assert len({type(pair) for pair in pairs}) == len(LAYOUTS)
    assert all(isinstance(pair, Pair) and type(pair).__name__ == "Pair" for pair in pairs)


def test_an_array_of_another_layout_changes_the_type():
    pair = Pair(first=LAYOUTS["contiguous"], second=np.ones(2))
    sums = (8.0, 14.0, 8.0, 30.0, 8.0)
    for each, value in zip((*LAYOUTS.values(), LAYOUTS["contiguous"]), sums, strict=True):
        pair.first = each
        assert total(pair) == value


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda pair: pickle.loads(pickle.dumps(pair))])
def test_a_copy_has_its_own_arrays(copied):
    pair = Pair(first=LAYOUTS["rows"].copy(), second=np.ones(2))
    other = copied(pair)
    pair.first[:] = 0.0
    assert (total(pair), total(other)) == (2.0, 30.0)


def test_structs_of_names_known_at_run_time():
    for first in LAYOUTS.values():
        assert total(struct(first=first, second=np.zeros(1))) == first.sum()


def test_compiled_code_finds_a_structure_behind_the_head_of_its_object():
    pair = Pair(first=np.zeros(1), second=np.zeros(1))
    behind = ctypes.c_void_p.from_address(id(pair) + object.__basicsize__).value
    assert behind == ctypes.addressof(pair)


def test_an_error_while_arrays_are_made_is_raised():
    """Or compiled code would read at the address 0."""
    pair = Pair(first=np.ones(1), second=np.zeros(1))
    assert total(pair) == 1.0
    pair._address = 0
    del pair.kernel_arrays
    with pytest.raises(AttributeError, match="kernel_arrays"):
        total(pair)


def test_threads_make_one_class():
    """numba knows a class by its address: of two the lesser used would be freed, and its address taken."""
    interval, barrier = sys.getswitchinterval(), Barrier(4)

    def make(written):
        barrier.wait()
        return type(written(first=np.zeros(1)))

    sys.setswitchinterval(1e-6)
    try:
        with ThreadPoolExecutor(4) as pool:
            for _ in range(300):
                written = type("Made", (Struct,), {"member_names": ("first",)})
                assert len(set(pool.map(make, [written] * 4))) == 1
    finally:
        sys.setswitchinterval(interval)
