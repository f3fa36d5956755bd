"""Filling rows of varying length: the nodes round the corners of a particle's domain, each named once."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device
from mpmfw.kernels.rows import add_scaled_row, set_scaled_row
from mpmfw.kernels.types import Float, Floats, Indices, Ints

#: As long as the corners of a domain in three dimensions: the size of scratch arrays with a row for each.
CORNERS = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

#: As long as an entry in three dimensions, φ and ∇φ: the size of scratch arrays with a column for each.
ENTRY = (0.0, 0.0, 0.0, 0.0)

#: What :func:`fill_domain` returns where a corner lies outside the window, and where the table is too short.
OUTSIDE, FULL = -1, -2


@device
def fill_domain(
    k: int,
    corner: Floats,
    share: Floats,
    slope: Floats,
    shape: Ints,
    offset: int,
    nodes: Indices,
    values: Floats,
    gradients: Floats,
    spacing: tuple[float, ...],
) -> int:
    """Write φ_i = Σ_c share_c N_i(x_c) and ∇φ_i = Σ_c slope_c N_i(x_c) from entry ``k`` on; return the entry after the last.

    N_i(x) = Π_d max(0, 1 − abs(x_d − i_d)), all in cells. The entries are the nodes of the smallest box that holds all that
    the corners touch: neighbouring corners share most of their nodes, and a row of 4**dim entries would be 3 times (2D) or
    4 times (3D) as long. The nested loops are written out for each dimension, as in
    :func:`fill_tensor_product`. ``corner`` (2**dim, dim) is counted from the window's first node, ``share`` (2**dim,), ``slope``
    (2**dim, dim) [1/m]. Returns ``OUTSIDE`` if a corner lies outside the window of ``shape`` nodes or is NaN,
    ``FULL`` if the row does not fit into the table; then nothing is written.
    """
    dim = len(spacing)
    low = scratch.integers(spacing)
    extent = scratch.integers(spacing)
    entries = 1
    for d in range(dim):
        first = last = corner[0, d]
        for c in range(1, 1 << dim):
            first, last = min(first, corner[c, d]), max(last, corner[c, d])
        if not (first >= 0.0 and last + 1.0 < shape[d]):
            return OUTSIDE
        low[d] = int(first)
        extent[d] = math.ceil(last) - low[d] + 1
        entries *= extent[d]
    if k + entries > len(nodes):
        return FULL
    if len(spacing) == 2:
        entry = np.uint64(k)
        for i in range(low[0], low[0] + extent[0]):
            for j in range(low[1], low[1] + extent[1]):
                phi, along_x, along_y = 0.0, 0.0, 0.0
                for c in range(4):
                    n = _hat(corner[c, 0] - i) * _hat(corner[c, 1] - j)
                    phi += share[c] * n
                    along_x += slope[c, 0] * n
                    along_y += slope[c, 1] * n
                nodes[entry] = offset + i * shape[1] + j
                values[entry], gradients[entry, 0], gradients[entry, 1] = phi, along_x, along_y
                entry += np.uint64(1)
    else:
        _write_in_space(
            k, corner, share, slope, low, extent, shape, offset, nodes, values, gradients, spacing
        )
    return k + entries


@device
def _write_in_space(
    k: int, corner: Floats, share: Floats, slope: Floats, low: Ints, extent: Ints, shape: Ints, offset: int, nodes: Indices,
    values: Floats, gradients: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Write the entries of :func:`fill_domain` in three dimensions, those of the box of ``extent`` nodes from ``low`` on.

    φ_i and ∇φ_i are one row of four, to which every corner adds its part.
    """
    at = scratch.matrix(spacing, CORNERS)  # axis by axis: the corners' weights are worked out side by side
    terms = scratch.matrix(CORNERS, ENTRY)
    total = scratch.matrix((0.0,), ENTRY)
    edge, n = scratch.vector(CORNERS), scratch.vector(CORNERS)
    entry = np.uint64(k)
    for c in range(8):
        terms[c, 0] = share[c]
        for d in range(3):
            at[d, c] = corner[c, d]
            terms[c, 1 + d] = slope[c, d]
    for i in range(low[0], low[0] + extent[0]):
        for j in range(low[1], low[1] + extent[1]):
            for c in range(8):
                edge[c] = _hat(at[0, c] - i) * _hat(at[1, c] - j)
            for l in range(low[2], low[2] + extent[2]):
                for c in range(8):
                    n[c] = edge[c] * _hat(at[2, c] - l)
                set_scaled_row(total, 0, n[0], terms, 0, ENTRY)
                for c in range(1, 8):
                    add_scaled_row(total, 0, n[c], terms, c, ENTRY)
                nodes[entry] = offset + (i * shape[1] + j) * shape[2] + l
                values[entry] = total[0, 0]
                for d in range(3):
                    gradients[entry, d] = total[0, 1 + d]
                entry += np.uint64(1)


@device
def _hat(x: Float) -> Float:
    """Linear function of a node, ``x`` cells away from it; a corner on a grid line has its whole weight on that line."""
    return max(1.0 - abs(x), 0.0)
