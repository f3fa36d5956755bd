"""Structs: arrays that kernels take as one argument."""

import copy
import pickle

import numpy as np
import pytest

from mpmfw.kernels import Floats, Ints, Struct, device, kernel
from mpmfw.step import team


class Points(Struct):
    place: Ints
    gap: Floats
    normal: Floats


class Named(Points):
    """A class farther down, with what Python alone sees."""

    label: str


@device
def along(c, points, by):
    total = 0.0
    for d in range(points.normal.shape[1]):
        total += points.normal[c, d] * by[d]
    return total


@kernel
def add_gaps(points, by):
    total = 0.0
    for c in range(len(points.gap)):
        points.gap[c] += along(c, points, by)
        total += points.gap[c] * points.place[c]
    return total


def points_of(n, kind=Points):
    rng = np.random.default_rng(n)
    return kind(place=np.arange(n), gap=rng.random(n), normal=rng.random((n, 2)))


def check(points):
    """The kernel reads and writes the object's own arrays."""
    by = np.array([2.0, -1.0])
    expected = points.gap + points.normal @ by
    total = add_gaps(points, by)
    np.testing.assert_allclose(points.gap, expected, rtol=1e-14)
    assert total == pytest.approx(points.gap @ points.place)


def test_a_kernel_reads_and_writes_the_members():
    check(points_of(5))
    check(points_of(0))


def test_arrays_that_take_others_places_are_seen():
    points = points_of(5)
    points.set(**points_of(70).members())
    check(points)
    points.gap = np.zeros(70)
    check(points)


def test_a_copy_has_arrays_of_its_own():
    points = points_of(4, Named)
    points.label = "a"
    for other in (copy.deepcopy(points), pickle.loads(pickle.dumps(points))):
        before = points.gap.copy()
        check(other)
        np.testing.assert_array_equal(points.gap, before)
        assert (other.label, other.member_names) == ("a", ("place", "gap", "normal"))


@kernel
def write_number(numbers, t):
    """Write t + 1 as thread t does."""
    team.write(numbers, t, t + 1)


def test_numbers_that_different_threads_write_share_no_line_of_the_cache():
    """Nearer ones would take the line from each other at every look."""
    numbers = np.zeros(8 * team.APART, dtype=np.int64)
    for t in range(4):
        write_number(numbers, t)
    (places,) = np.nonzero(numbers)
    assert set(np.diff(places) * numbers.itemsize) == {64}
    assert [team.wait(numbers, t, t + 1, 1) for t in range(4)] == [True] * 4
