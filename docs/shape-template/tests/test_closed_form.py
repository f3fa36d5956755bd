"""The table against the published formulas, written down a second time in plain NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from mpmfw.api.shape import OutsideGrid
from mpmfw_testing import subject_of
from mpmfw_testing.shape import boxes, dense, place

from mpmfw_bounded_bspline import BoundedBSpline

CELLS = 10
DIMENSIONS = pytest.mark.parametrize("dim", [2, 3], ids=["2D", "3D"])
#: Central differences of a piece-wise quadratic are exact but for a step across a knot and for rounding.
STEP, ROUGH = 1e-6, 1e-8


def quadratic(r):
    """B²(r) = ¾ − r² for |r| < ½, ½(3/2 − |r|)² for |r| < 3/2."""
    r = np.abs(r)
    return np.select([r < 0.5, r < 1.5], [0.75 - r**2, 0.5 * (1.5 - r) ** 2], 0.0)


def table_at(position, **options):
    """φ and h ∇φ of one point at ``position`` [cells] on the whole grid."""
    position = np.atleast_2d(position)
    placed = place(subject_of(BoundedBSpline, "shape", options), [boxes(position, 0.5)], CELLS)
    return dense(placed.table(), 0, placed.grid)


def outer(values):
    """Tensor product of one array an axis."""
    product = np.ones(())
    for each in values:
        product = np.multiply.outer(product, each)
    return product


@DIMENSIONS
@pytest.mark.parametrize("seed", range(5))
def test_inside_the_grid_it_is_the_quadratic_b_spline(dim, seed):
    position = np.random.default_rng(seed).uniform(2.0, CELLS - 2.0, dim)
    weight, gradient = table_at(position)
    nodes = np.arange(CELLS + 1)
    splines = [quadratic(x - nodes) for x in position]
    np.testing.assert_allclose(weight, outer(splines), atol=1e-14)
    for axis, x in enumerate(position):
        slope = (quadratic(x + STEP - nodes) - quadratic(x - STEP - nodes)) / (2.0 * STEP)
        expected = outer([slope if a == axis else spline for a, spline in enumerate(splines)])
        np.testing.assert_allclose(gradient[..., axis], expected, atol=ROUGH)


@pytest.mark.parametrize("xi", [0.0, 0.1, 0.3, 0.5 - 1e-12])
def test_in_the_grids_first_half_cell_it_is_linear(xi):
    weight, gradient = table_at([xi, 5.3])
    middle = quadratic(5.3 - np.arange(CELLS + 1))
    np.testing.assert_allclose(weight[:2], np.outer([1.0 - xi, xi], middle), atol=1e-11)
    assert not weight[2:].any()
    np.testing.assert_allclose(gradient[:2, :, 0], np.outer([-1.0, 1.0], middle), atol=1e-11)


@DIMENSIONS
@pytest.mark.parametrize("xi", [0.0, 0.3, 1.0])
def test_the_last_cell_is_the_mirror_image_of_the_first(dim, xi):
    start, end = np.full(dim, xi), np.full(dim, CELLS - xi)
    (first, slope), (last, reverse) = table_at(start), table_at(end)
    axes = tuple(range(dim))
    np.testing.assert_allclose(last, np.flip(first, axes), atol=1e-14)
    np.testing.assert_allclose(reverse, -np.flip(slope, axes), atol=1e-14)


@pytest.mark.parametrize("xi", [0.0, 0.2, 0.8, CELLS - 0.4, float(CELLS)])
def test_modified_splines_reproduce_linear_fields(xi):
    weight, gradient = table_at([xi, 4.1])
    x = np.arange(CELLS + 1)[:, None]
    assert weight.min() >= -1e-15
    assert weight.sum() == pytest.approx(1.0, abs=1e-13)
    assert (weight * x).sum() == pytest.approx(xi, abs=1e-13)
    assert (gradient[..., 0] * x).sum() == pytest.approx(1.0, abs=1e-13)


def test_the_derivative_is_continuous_where_linear_functions_begin():
    slopes = [table_at([0.5 + x, 5.3])[1][..., 0] for x in (-1e-9, 1e-9)]
    np.testing.assert_allclose(*slopes, atol=1e-8)


@pytest.mark.parametrize("position", [[0.4, 5.0], [5.0, CELLS - 0.4]])
def test_refuse_reports_a_point_in_the_last_half_cell(position):
    with pytest.raises(OutsideGrid):
        table_at(position, grid_end="refuse")


@pytest.mark.parametrize("position", [[-0.01, 5.0], [5.0, CELLS + 0.01]])
def test_a_point_outside_the_grid_is_reported(position):
    with pytest.raises(OutsideGrid):
        table_at(position)
