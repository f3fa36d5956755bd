"""Windows of velocity fields on the background grid."""

from types import SimpleNamespace

import numpy as np
import pytest

from mpmfw.state.windows import fit_windows, make_grid

H = 0.25


def laid(*bodies):
    """A grid from −2 to 3 m with the windows of some bodies, whose points have no extent."""
    grid = make_grid(H, np.full(2, -2.0), np.full(2, 3.0), len(bodies))
    first = np.cumsum([0, *(len(body) for body in bodies)])
    points = SimpleNamespace(position=np.concatenate(bodies).astype(float), first=first)
    state = SimpleNamespace(grid=grid, particles=points, surface=None, near=None)
    fit_windows(state, SimpleNamespace(particle_reach=lambda particles: np.zeros_like(particles.position)))
    return grid


@pytest.mark.parametrize(("length", "cells"), [(1.0, 10), (1.0 + 1e-12, 10), (1.01, 11), (0.3, 3)])
def test_the_grid_reaches_at_least_to_its_upper_end(length, cells):
    # 0.3 / 0.1 is a bit more than 3 in floating point, and still three cells
    grid = make_grid(0.1, np.zeros(2), np.array([length, 0.5]), 1)
    assert grid.nodes.tolist() == [cells + 1, 6]


@pytest.mark.parametrize("far", [np.nan, np.inf, -np.inf, 1e300])
def test_a_lost_point_does_not_break_the_laying(far):
    # The shape function's fill then reports the point, with its name.
    grid = laid([[0.1, 0.1], [far, 0.1]])
    assert (grid.window_shape >= 1).all()
    assert (grid.window_lower >= 0).all()
    assert (grid.window_lower + grid.window_shape <= grid.nodes).all()
