"""Logarithmic barriers: their derivatives, the distance that a pressure has, and the time to touch."""

from __future__ import annotations

import numpy as np
import pytest

from mpmfw_contact._barriers import barrier, barrier_curvature, barrier_slope

AT = np.array([0.01, 0.1, 0.3, 0.5, 0.9, 0.999])


def of(function, at):
    return np.array([function(float(s)) for s in at])


def test_slope_and_curvature_are_the_barrier_s():
    step = 1e-6 * AT
    slope = (of(barrier, AT - step) - of(barrier, AT + step)) / (2.0 * step)
    np.testing.assert_allclose(of(barrier_slope, AT), slope, rtol=1e-6, atol=1e-9)
    curvature = (of(barrier_slope, AT - step) - of(barrier_slope, AT + step)) / (2.0 * step)
    np.testing.assert_allclose(of(barrier_curvature, AT), curvature, rtol=1e-6)


@pytest.mark.parametrize("function", [barrier, barrier_slope, barrier_curvature])
def test_beyond_its_reach_there_is_none(function):
    assert [function(s) for s in (1.0, 1.5)] == [0.0, 0.0]
    assert function(1.0 - 1e-9) < 1e-8


def test_it_grows_without_bound():
    assert barrier_slope(1e-6) > 9e5


def test_the_barrier_is_that_of_the_ipc_toolkit():
    ipctk = pytest.importorskip("ipctk")
    published, reach = ipctk.ClampedLogBarrier(), 0.7
    for s in AT:
        d = float(s) * reach
        assert reach**2 * barrier(float(s)) == pytest.approx(published(d, reach), rel=1e-12)
        assert -reach * barrier_slope(float(s)) == pytest.approx(
            published.first_derivative(d, reach), rel=1e-12
        )
        assert barrier_curvature(float(s)) == pytest.approx(
            published.second_derivative(d, reach), rel=1e-9, abs=1e-12
        )
