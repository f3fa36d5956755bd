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
    """Write φ_i = Σ_c share_c N_i(x_c) and ∇φ_i = Σ_c slope_c N_i(x_c) from entry ``k`` on; return the entry
    after the last.

    N_i(x) = Π_d max(0, 1 − abs(x_d − i_d)), all in cells. The entries are the nodes of the smallest box that
    holds all that the corners touch: neighbouring corners share most of their nodes, and a row of 4**dim
    entries would be 3 times (2D) or 4 times (3D) as long. ``corner`` (2**dim, dim) is counted from the
    window's first node, ``share`` (2**dim,), ``slope`` (2**dim, dim) [1/m]. Returns ``OUTSIDE`` if a corner
    lies outside the window of ``shape`` nodes or is NaN, ``FULL`` if the row does not fit into the table;
    then nothing is written."""
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
    _write_box(k, corner, share, slope, low, extent, shape, offset, nodes, values, gradients, spacing)
    return k + entries


@device
def _write_box(
    k: int, corner: Floats, share: Floats, slope: Floats, low: Ints, extent: Ints, shape: Ints, offset: int,
    nodes: Indices,
    values: Floats, gradients: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Write the entries of :func:`fill_domain`, those of the box of ``extent`` nodes from ``low`` on.

    φ_i and ∇φ_i are one row, to which every corner adds its part.
    """
    dim = len(spacing)
    n_corners = 1 << dim
    entry_like = (0.0, *spacing)
    at = scratch.matrix(spacing, CORNERS)  # axis by axis: the corners' weights are worked out side by side
    terms = scratch.matrix(CORNERS, entry_like)
    total = scratch.matrix((0.0,), entry_like)
    edge, n = scratch.vector(CORNERS), scratch.vector(CORNERS)
    for c in range(n_corners):
        terms[c, 0] = share[c]
        for d in range(dim):
            at[d, c] = corner[c, d]
            terms[c, 1 + d] = slope[c, d]
    entry = np.uint64(k)
    for plane in range(extent[0] if dim == 3 else 1):
        for j in range(low[dim - 2], low[dim - 2] + extent[dim - 2]):
            first = offset + j * shape[dim - 1]
            for c in range(n_corners):
                edge[c] = _hat(at[dim - 2, c] - j)
            if dim == 3:
                i = low[0] + plane
                first += i * shape[1] * shape[2]
                for c in range(n_corners):
                    edge[c] *= _hat(at[0, c] - i)
            for l in range(low[dim - 1], low[dim - 1] + extent[dim - 1]):
                for c in range(n_corners):
                    n[c] = edge[c] * _hat(at[dim - 1, c] - l)
                set_scaled_row(total, 0, n[0], terms, 0, entry_like)
                for c in range(1, n_corners):
                    add_scaled_row(total, 0, n[c], terms, c, entry_like)
                nodes[entry] = first + l
                values[entry] = total[0, 0]
                for d in range(dim):
                    gradients[entry, d] = total[0, 1 + d]
                entry += np.uint64(1)


@device
def _hat(x: Float) -> Float:
    """Linear function of a node, ``x`` cells away from it; a corner on a grid line has its whole weight on
    that line.
    """
    return max(1.0 - abs(x), 0.0)
