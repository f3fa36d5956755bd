"""Windows of velocity fields on the background grid."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mpmfw.state.windows import MARGIN, fit_windows, make_grid

H = 0.25


def particles(*bodies: Any) -> Any:
    """Points of several velocity fields."""
    first = np.cumsum([0, *(len(body) for body in bodies)])
    return SimpleNamespace(
        position=np.concatenate([np.array(body, dtype=float) for body in bodies]), first=first
    )


def laid(*bodies: Any, reach: float = 0.0, surface: Any = None, dim: int = 2) -> Any:
    """A grid from −2 to 3 m with the windows of some bodies."""
    grid = make_grid(H, np.full(dim, -2.0), np.full(dim, 3.0), len(bodies))
    points = particles(*bodies)
    fit_windows(grid, points, np.full_like(points.position, reach), surface)
    return grid


@pytest.mark.parametrize(("length", "cells"), [(1.0, 10), (1.0 + 1e-12, 10), (1.01, 11), (0.3, 3)])
def test_the_grid_reaches_at_least_to_its_upper_end(length: float, cells: int) -> None:
    # 0.3 / 0.1 is a bit more than 3 in floating point, and still three cells
    grid = make_grid(0.1, np.zeros(2), np.array([length, 0.5]), 1)
    assert grid.nodes.tolist() == [cells + 1, 6]


def test_a_window_holds_its_points_and_the_margin() -> None:
    grid = laid([[0.1, 0.1], [0.6, 0.2]], reach=0.05)
    first = np.array([8, 8]) - MARGIN  # the node below (0.05, 0.05) is the background's (8, 8)
    last = np.array([10, 9]) + 1 + MARGIN  # above (0.65, 0.25): (11, 10), as 0.25 is on a line
    assert grid.window_lower[0].tolist() == first.tolist()
    assert (grid.window_lower[0] + grid.window_shape[0] - 1).tolist() == last.tolist()


def test_nodes_of_two_windows_lie_one_after_the_other_and_agree_to_the_last_bit() -> None:
    grid = laid([[0.1, 0.1]], [[0.4, 0.3]])
    assert grid.offset.tolist() == [0, *np.cumsum(np.prod(grid.window_shape, axis=1))]
    assert all(
        len(array) == grid.offset[-1] for array in (grid.position, grid.mass, grid.momentum, grid.velocity)
    )
    nodes = []
    for field in range(2):
        own = grid.field_nodes(field)
        index = np.stack(
            np.meshgrid(*[np.arange(n) for n in grid.window_shape[field]], indexing="ij"), -1
        ).reshape(-1, 2)
        background = index + grid.window_lower[field]
        np.testing.assert_allclose(grid.position[own], -2.0 + H * background)
        nodes.append(dict(zip(map(tuple, background.tolist()), grid.position[own].tolist(), strict=True)))
    shared = nodes[0].keys() & nodes[1].keys()
    assert shared
    assert all(nodes[0][key] == nodes[1][key] for key in shared)


def test_surface_nodes_widen_their_own_fields_window() -> None:
    surface = SimpleNamespace(position=np.array([[1.6, 0.1]]), first=np.array([0, 0, 1]))
    plain, wide = laid([[0.1, 0.1]], [[0.1, 0.1]]), laid([[0.1, 0.1]], [[0.1, 0.1]], surface=surface)
    assert wide.window_shape[0].tolist() == plain.window_shape[0].tolist()
    assert wide.window_shape[1].tolist() == [plain.window_shape[1, 0] + 6, plain.window_shape[1, 1]]


@pytest.mark.parametrize("far", [np.nan, np.inf, -np.inf, 1e300])
def test_a_lost_point_does_not_break_the_laying(far: float) -> None:
    # The shape function's fill then reports the point, with its name.
    grid = laid([[0.1, 0.1], [far, 0.1]])
    assert (grid.window_shape >= 1).all()
    assert (grid.window_lower >= 0).all()
    assert (grid.window_lower + grid.window_shape <= grid.nodes).all()
