"""Numbers by which threads wait for each other: where they lie, and what is read from them."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmfw.kernels import kernel
from mpmfw.step import threads


@kernel
def write_number(numbers: Any, t: int) -> None:
    """Write t + 1 as thread t does."""
    threads.write(numbers, t, t + 1)


def test_numbers_that_different_threads_write_share_no_line_of_the_cache() -> None:
    """Nearer ones would take the line from each other at every look."""
    numbers = np.zeros(8 * threads.APART, dtype=np.int64)
    for t in range(4):
        write_number(numbers, t)
    (places,) = np.nonzero(numbers)
    assert set(np.diff(places) * numbers.itemsize) == {64}
    assert [threads.wait(numbers, t, t + 1, 1) for t in range(4)] == [True] * 4
