"""Compact kernels on two staggered grids: the table against the published formula, and sides that are
held.
"""

from __future__ import annotations

import numpy as np
import pytest

import mpmfw
from mpmfw_shape.ck import CompactKernel
from mpmfw_testing import subject_of
from mpmfw_testing.shape import boxes, dense, place

CELLS = 10
DIMENSIONS = pytest.mark.parametrize("dim", [2, 3], ids=["2D", "3D"])
#: Derivative by central differences of 1e-5 cells: step² / 6 of the kernel's third derivative.
STEP, ROUGH = 1e-5, 1e-8


def compact(r):
    """K(r) = 1 − |r| + sin(2π|r|) / (2π) for |r| ≤ 1."""
    r = np.minimum(np.abs(r), 1.0)
    return 1.0 - r + np.sin(2.0 * np.pi * r) / (2.0 * np.pi)


def expected_weights(position):
    """φ on all nodes of the grid: half of the product of kernels over two cells, where all indices are even
    or all odd.
    """
    index = np.indices((CELLS + 1,) * len(position))
    kernels = np.prod([compact((x - own) / 2.0) for x, own in zip(position, index, strict=True)], axis=0)
    same = (index % 2 == index[0] % 2).all(axis=0)
    return np.where(same, 0.5 * kernels, 0.0)


def table_at(position):
    """φ and h ∇φ of one point at ``position`` [cells] on the whole grid."""
    placed = place(subject_of(CompactKernel, "shape"), [boxes(np.atleast_2d(position), 0.5)], CELLS)
    return dense(placed.table(), 0, placed.grid)


@DIMENSIONS
@pytest.mark.parametrize("seed", range(6))
def test_it_is_the_mean_of_both_grids(dim, seed):
    position = np.random.default_rng(seed).uniform(2.0, CELLS - 2.0, dim)
    weight, gradient = table_at(position)
    np.testing.assert_allclose(weight, expected_weights(position), atol=1e-14)
    for axis in range(dim):
        step = STEP * np.eye(dim)[axis]
        slope = (expected_weights(position + step) - expected_weights(position - step)) / (2.0 * STEP)
        np.testing.assert_allclose(gradient[..., axis], slope, atol=ROUGH)


@pytest.mark.parametrize("lower", [-0.6, -0.53], ids=["odd", "between"])
def test_sides_hold_a_block_wherever_the_grids_lie(lower):
    """Driven down by a tenth between smooth walls: mean σ_yy of uniaxial strain; without sides it would be a
    tenth of it.
    """
    bulk, shear = 12e6, 6e6
    side = {"bottom": {"fixed": ["y"]}, "left": {"fixed": ["x"]}, "right": {"fixed": ["x"]}}
    scene = {
        "grid": {"cell_size": 0.1, "lower": [lower] * 2, "upper": [lower + 2.1] * 2},
        "time": {"end": 0.3535534, "output_interval": 0.3535534},
        "shape": {"method": "ck"},
        "materials": {
            "soft": {"model": "neo_hookean", "density": 1000, "bulk_modulus": bulk, "shear_modulus": shear}
        },
        "bodies": {
            "block": {
                "material": "soft",
                "geometry": {"type": "rectangle", "lower": [0.0, 0.0], "upper": [1.0, 1.0]},
                "particles": {"layout": "fitted", "size": "0.5 cells"},
                "sides": [
                    *({"side": name, **how} for name, how in side.items()),
                    {"side": "top", "velocity": ["free", -0.28284271]},
                ],
            }
        },
    }
    stress = mpmfw.run(scene)["particles/block"]["stress"].isel(time=-1).values[:, 1, 1]
    j = 0.9
    exact = 0.5 * bulk * (j - 1.0 / j) + shear * j ** (-5.0 / 3.0) * (j * j - (2.0 + j * j) / 3.0)
    assert stress.mean() / exact == pytest.approx(1.0, abs=0.02)
    assert np.abs(stress / exact - 1.0).max() < 0.25
