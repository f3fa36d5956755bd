"""Compact kernels on two staggered grids (Liu, Wang & Li 2025): smooth gradients from the nodes of a point's
own cells.

M. Liu, X. Wang, M. Li (2025): CK-MPM: a compact-kernel material point method. ACM Transactions on Graphics 44
(4).

In each direction K(r) = 1 − |r| + sin(2π|r|) / (2π) for |r| ≤ 1, twice continuously differentiable, and Σ K =
1 on one grid. A linear field is not interpolated exactly by one grid, but by the mean of two that are
staggered by half a cell: their errors are opposite. Here both are parts of the scene's grid of cell h, each a
grid of cell 2h: nodes whose indices are all even, and those whose indices are all odd. Nodes of mixed indices
have no mass. So ``grid.cell_size`` is half of what the paper calls Δx.
"""

from __future__ import annotations

import math

import numpy as np

from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.stencil import fits, read_window
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Table
from mpmfw_shape._tables import AtPoints

#: Nodes along each axis whose kernels hold a point, two of each grid.
WIDTH = 4


@device
def compact_weights(xi: Float, inverse_h: Float, d: int, base: Floats, weight: Floats, slope: Floats) -> None:
    """The four kernels K((ξ − i) / 2) whose support holds ``xi`` [cells] along axis ``d``, and their slopes
    [1/m]."""
    cell = np.floor(xi)
    base[d] = cell - 1.0
    t = xi - cell
    bend, turn = math.sin(math.pi * t) / (2.0 * math.pi), math.cos(math.pi * t)
    weight[d, 0] = 0.5 * (1.0 - t) - bend
    weight[d, 1] = 1.0 - 0.5 * t + bend
    weight[d, 2] = 0.5 * (1.0 + t) + bend
    weight[d, 3] = 0.5 * t - bend
    slope[d, 0] = -0.5 * (1.0 + turn) * inverse_h
    slope[d, 1] = -0.5 * (1.0 - turn) * inverse_h
    slope[d, 2] = -slope[d, 0]
    slope[d, 3] = -slope[d, 1]


@device
def fill_grids(
    k: int, base: Floats, even: Ints, weight: Floats, slope: Floats, shape: Ints, offset: int, table: Table,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Write the 2 · 2**dim entries of one point from ``k`` on, their nodes ascending.

    Of the four nodes along axis d the first with an even index in the grid is ``even[d]``, 0 or 1: with one
    of the same parity along all axes a node belongs to a grid. As
    :func:`mpmfw.kernels.stencil.fill_tensor_product` else.
    """
    nodes, values, gradients = table.nodes, table.weight, table.gradient
    for a in range(WIDTH):
        odd = (a + even[0]) % 2
        for b in range((even[1] + odd) % 2, WIDTH, 2):
            line = (int(base[0]) + a) * shape[1] + int(base[1]) + b
            w = 0.5 * weight[0, a] * weight[1, b]
            s_a, s_b = slope[0, a] * weight[1, b], weight[0, a] * slope[1, b]
            if len(spacing) == 2:
                nodes[k], values[k] = offset + line, w
                if len(gradients) > 0:
                    gradients[k, 0], gradients[k, 1] = 0.5 * s_a, 0.5 * s_b
                k += 1
            else:
                for c in range((even[2] + odd) % 2, WIDTH, 2):
                    nodes[k], values[k] = offset + line * shape[2] + int(base[2]) + c, w * weight[2, c]
                    if len(gradients) > 0:
                        gradients[k, 0] = 0.5 * s_a * weight[2, c]
                        gradients[k, 1] = 0.5 * s_b * weight[2, c]
                        gradients[k, 2] = w * slope[2, c]
                    k += 1


@kernel
def fill_compact(position: Floats, first: Ints, grid: Nodes, table: Table, spacing: tuple[float, ...]) -> int:
    """Compact kernels at points; 2 · 2**dim entries each. Return the first point outside its window, or
    −1."""
    dim, inverse_h = len(spacing), 1.0 / spacing[0]
    origin, base = scratch.vector(spacing), scratch.vector(spacing)
    shape, even = scratch.integers(spacing), scratch.integers(spacing)
    w = scratch.matrix(spacing, (0.0, 0.0, 0.0, 0.0))
    s = scratch.matrix(spacing, (0.0, 0.0, 0.0, 0.0))
    for f in range(len(first) - 1):
        read_window(grid, f, origin, shape, spacing)
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                compact_weights((position[p, d] - origin[d]) * inverse_h, inverse_h, d, base, w, s)
            if not fits(base, WIDTH, shape, spacing):
                return p
            for d in range(dim):
                even[d] = (grid.window_lower[f, d] + int(base[d])) % 2
            fill_grids(p * 2 ** (dim + 1), base, even, w, s, shape, grid.offset[f], table, spacing)
    return -1


class CompactKernel(AtPoints):
    """φ_ip = ½ Π_d K((x_p − x_i)_d / 2h) on two staggered grids: 8 nodes in 2D, 16 in 3D."""

    name = "ck"
    staggered = True
    divisible = False  # nodes of both grids would have to be
    #: A cell's corners belong to two grids, so that it has no spin.
    auto_rotation = "exact"
    functions = (fill_compact, WIDTH)

    def entries(self, dim: int) -> int:
        """Two nodes along each axis on each of two grids."""
        return int(2 * 2**dim)
