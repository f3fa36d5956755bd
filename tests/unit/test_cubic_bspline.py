"""Cubic B-splines: the table against the published formulas, written down a second time, and a body at the
grid's end.
"""

from __future__ import annotations

import numpy as np
import pytest

import mpmfw
from mpmfw.api import SceneError
from mpmfw_shape.cubic_bspline import CubicBSpline
from mpmfw_testing import subject_of
from mpmfw_testing.shape import boxes, dense, place

CELLS = 10
DIMENSIONS = pytest.mark.parametrize("dim", [2, 3], ids=["2D", "3D"])
#: Derivative of a piece-wise cubic by central differences of 1e-5 cells: step² / 6 of its third derivative.
STEP, ROUGH = 1e-5, 1e-8


def cubic(r):
    """B³(r) = 2/3 − r² + |r|³/2 for |r| < 1, (2 − |r|)³/6 for |r| < 2."""
    r = np.abs(r)
    return np.select([r < 1.0, r < 2.0], [2.0 / 3.0 - r**2 + r**3 / 2.0, (2.0 - r) ** 3 / 6.0], 0.0)


def at_the_end(xi):
    """Steffen's splines of the first four nodes, at ξ in [0, 1] cells from the grid's first node."""
    return np.array([xi**3 / 6.0 - xi + 1.0, -(xi**3) / 3.0 + xi, xi**3 / 6.0, 0.0])


def table_at(position, **options):
    """φ and h ∇φ of one point at ``position`` [cells] on the whole grid."""
    position = np.atleast_2d(position)
    placed = place(subject_of(CubicBSpline, "shape", options), [boxes(position, 0.5)], CELLS)
    return dense(placed.table(), 0, placed.grid)


def outer(values):
    """Tensor product of one array an axis."""
    product = np.ones(())
    for each in values:
        product = np.multiply.outer(product, each)
    return product


@DIMENSIONS
@pytest.mark.parametrize("seed", range(5))
def test_inside_the_grid_it_is_the_cubic_b_spline(dim, seed):
    position = np.random.default_rng(seed).uniform(2.0, CELLS - 2.0, dim)
    weight, gradient = table_at(position)
    nodes = np.arange(CELLS + 1)
    splines = [cubic(x - nodes) for x in position]
    np.testing.assert_allclose(weight, outer(splines), atol=1e-14)
    for axis, x in enumerate(position):
        slope = (cubic(x + STEP - nodes) - cubic(x - STEP - nodes)) / (2.0 * STEP)
        expected = outer([slope if a == axis else spline for a, spline in enumerate(splines)])
        np.testing.assert_allclose(gradient[..., axis], expected, atol=ROUGH)


@pytest.mark.parametrize("xi", [0.0, 0.1, 0.5, 0.9, 1.0 - 1e-12])
def test_in_the_grids_first_cell_it_is_the_modified_spline(xi):
    weight, gradient = table_at([xi, 5.3])
    middle = cubic(5.3 - np.arange(CELLS + 1))
    np.testing.assert_allclose(weight[:4], np.outer(at_the_end(xi), middle), atol=1e-14)
    assert not weight[4:].any()
    slope = np.array([0.5 * xi**2 - 1.0, 1.0 - xi**2, 0.5 * xi**2, 0.0])
    np.testing.assert_allclose(gradient[:4, :, 0], np.outer(slope, middle), atol=1e-14)


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


RUBBER = {"model": "neo_hookean", "density": 1000.0, "bulk_modulus": 1e5, "shear_modulus": 5e4}


@pytest.mark.parametrize("where", ["modified", "refuse"])
def test_a_body_in_the_grids_last_cell(where):
    """A square at the grid's first corner flies inwards; unless the end is modified, its points are
    refused.
    """
    scene = {
        "grid": {"cell_size": 0.1, "lower": [0.0, 0.0], "upper": [1.0, 1.0]},
        "time": {"end": 0.05, "output_interval": 0.05},
        "materials": {"rubber": RUBBER},
        "bodies": {
            "square": {
                "material": "rubber",
                "geometry": {"type": "rectangle", "lower": [0.0, 0.0], "upper": [0.4, 0.4]},
                "particles": {"layout": "fitted", "size": 0.05},
                "velocity": [1.0, 1.0],
            }
        },
        "shape": {"method": "cubic_bspline", "cubic_bspline": {"grid_end": where}},
    }
    if where == "refuse":
        with pytest.raises(SceneError, match="reaches beyond the grid"):
            mpmfw.run(scene)
        return
    series = mpmfw.run(scene)["series"].to_dataset().sel(body="square")
    moved = series["centre_of_mass"].isel(time=-1) - series["centre_of_mass"].isel(time=0)
    np.testing.assert_allclose(moved, 0.05, rtol=1e-9)
