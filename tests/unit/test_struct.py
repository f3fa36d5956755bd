"""Structs: arrays that kernels take as one argument."""

import copy
import pickle

import numpy as np
import pytest

from mpmfw.kernels import Floats, Ints, Struct, device, kernel


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


def test_a_copy_has_arrays_of_its_own():
    points = points_of(4, Named)
    points.label = "a"
    for other in (copy.deepcopy(points), pickle.loads(pickle.dumps(points))):
        before = points.gap.copy()
        check(other)
        np.testing.assert_array_equal(points.gap, before)
        assert (other.label, other.member_names) == ("a", ("place", "gap", "normal"))
