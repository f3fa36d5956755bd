"""The compiled part: one function for one axis, and one loop over points that fills the table.

Rules for kernels, from ``mpmfw.kernels``: loops over ``range(dim)`` with ``dim = len(spacing)``, so that one
source serves 2D and 3D; scratch arrays on the stack; ``@device`` for what kernels call, ``@kernel`` for what
Python calls, which keeps it compiled on disk.
"""

from __future__ import annotations

import numpy as np
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.stencil import fill_tensor_product, fits, read_window
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Table

#: Splines, hence nodes, along each axis whose support holds a point.
WIDTH = 3


@device
def quadratic_weights(
    xi: Float, inverse_h: Float, d: int, base: Floats, weight: Floats, slope: Floats
) -> None:
    """The three quadratic B-splines whose support holds ``xi`` [cells] along axis ``d``, and their slopes
    [1/m].

    With t = ξ − ``base[d]``, ½ ≤ t ≤ 3/2, they are ½(3/2 − t)², ¾ − (t − 1)² and ½(t − ½)², for the node
    ``base[d]`` and the two after it."""
    base[d] = np.floor(xi - 0.5)
    t = xi - base[d]
    weight[d, 0] = 0.5 * (1.5 - t) ** 2
    weight[d, 1] = 0.75 - (t - 1.0) ** 2
    weight[d, 2] = 0.5 * (t - 0.5) ** 2
    slope[d, 0] = (t - 1.5) * inverse_h
    slope[d, 1] = -2.0 * (t - 1.0) * inverse_h
    slope[d, 2] = (t - 0.5) * inverse_h


@device
def fold_at_start(d: int, values: Floats) -> None:
    """Give the share of the node before the grid's first to nodes 0 and 1.

    The missing node is read by linear extrapolation, u_{−1} = 2 u_0 − u_1: what is left are 1 − ξ and ξ, the
    linear functions. They keep Σ φ = 1 and Σ φ x = x, are nowhere negative, and the first node alone is felt
    at the grid's end. The freed third entry becomes zero."""
    ghost = values[d, 0]
    values[d, 0] = values[d, 1] + 2.0 * ghost
    values[d, 1] = values[d, 2] - ghost
    values[d, 2] = 0.0


@device
def fold_at_end(d: int, values: Floats) -> None:
    """As :func:`fold_at_start`, for the node after the grid's last."""
    ghost = values[d, 2]
    values[d, 2] = values[d, 1] + 2.0 * ghost
    values[d, 1] = values[d, 0] - ghost
    values[d, 0] = 0.0


@kernel
def fill_bounded(
    position: Floats, first: Ints, grid: Nodes, table: Table, spacing: tuple[float, ...], modified: bool
) -> int:
    """Quadratic B-splines at points; 3**dim entries each. Return the first point outside its window, or −1.

    Points ``first[f]:first[f + 1]`` belong to velocity field ``f``, whose window has its own first node and
    shape. Where a window ends only because nobody needed more of it, the point is reported and the core lays
    the window anew; where it ends with the grid, the splines are ``modified``, or the point is reported too.
    A gradient of length 0 is not written.
    """
    dim, inverse_h = len(spacing), 1.0 / spacing[0]
    origin, shape, base = scratch.vector(spacing), scratch.integers(spacing), scratch.vector(spacing)
    w = scratch.matrix(spacing, (0.0, 0.0, 0.0))
    s = scratch.matrix(spacing, (0.0, 0.0, 0.0))
    for f in range(len(first) - 1):
        read_window(grid, f, origin, shape, spacing)
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                xi = (position[p, d] - origin[d]) * inverse_h
                at_start = modified and grid.window_lower[f, d] == 0
                at_end = modified and grid.window_lower[f, d] + shape[d] == grid.nodes[d]
                quadratic_weights(xi, inverse_h, d, base, w, s)
                if at_start and 0.0 <= xi < 0.5:
                    fold_at_start(d, w)
                    fold_at_start(d, s)
                    base[d] = 0.0
                elif at_end and shape[d] - 1.5 <= xi <= shape[d] - 1:
                    fold_at_end(d, w)
                    fold_at_end(d, s)
                    base[d] -= 1.0
            if not fits(base, WIDTH, shape, spacing):
                return p
            fill_tensor_product(p * WIDTH**dim, WIDTH, base, w, s, shape, grid.offset[f], table, spacing)
    return -1
