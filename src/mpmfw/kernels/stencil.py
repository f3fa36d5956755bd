"""Interpolation tables: reading rows, and filling them with tensor products or with the domains of points."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.arithmetic import add_scaled_row, multiply_by_hats, set_scaled_row
from mpmfw.kernels.types import Float, Floats, Indices, Ints, Nodes, Table

#: First node of a part of the nodes, and the one after its last.
NodeRange: TypeAlias = tuple[int, int]


@device
def entries(row: Ints, p: int) -> range:
    """Entries of point ``p``: unsigned, so that no index of the loop is asked whether it counts from the
    end."""
    return range(np.uint64(row[p]), np.uint64(row[p + 1]))


@device
def node_of(nodes: Indices, k: int) -> np.uint64:
    """Node of entry ``k``: unsigned, as in :func:`entries`."""
    return np.uint64(nodes[k])


@device
def is_apart(row: Ints, nodes: Indices, p: int, own_nodes: NodeRange) -> bool:
    """Return True if no node of point ``p`` is among ``own_nodes``; the nodes of a row ascend."""
    begin, end = np.uint64(row[p]), np.uint64(row[p + 1])
    return bool(begin == end or nodes[end - np.uint64(1)] < own_nodes[0] or nodes[begin] >= own_nodes[1])


@device
def own_entries(table: Table, p: int, own_nodes: NodeRange | None) -> tuple[Any, Any]:
    """First entry and number of entries of point ``p`` whose nodes are among ``own_nodes``, all of them
    without one; the nodes of a row ascend.

    A loop over a number that the compiler knows takes three quarters of the time.
    """
    if own_nodes is None and table.width > 0:
        return np.uint64(p * table.width), table.width
    one, begin, end = np.uint64(1), np.uint64(table.row[p]), np.uint64(table.row[p + 1])
    if own_nodes is not None:
        while begin < end and table.nodes[begin] < own_nodes[0]:
            begin += one
        while begin < end and table.nodes[end - one] >= own_nodes[1]:
            end -= one
    return begin, np.int64(end - begin)


@device
def read_window(grid: Nodes, f: int, origin: Floats, shape: Ints, spacing: tuple[float, ...]) -> None:
    """Position of the first node of velocity field ``f``'s window [m] and its number of nodes.

    On the stack the compiler can assume that writing to the table does not change them.
    """
    for d in range(len(spacing)):
        origin[d] = grid.lower[d] + grid.window_lower[f, d] * spacing[d]
        shape[d] = grid.window_shape[f, d]


#: Most nodes along an axis in a tensor product; with a bound the compiler unrolls the loops over them.
WIDEST = 8


@device
def fill_tensor_product(
    k: int, width: int, base: Floats, weight: Floats, slope: Floats, shape: Ints, offset: int, table: Table,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """Write the ``width**dim`` entries of one point from ``k`` on.

    N = Π_d w_d and ∂N/∂x_e = w'_e Π_{d≠e} w_d, where ``weight[d, a]`` is w_d of node ``base[d] + a`` and
    ``slope`` its derivative [1/m]. A gradient of length 0 is not written. ``shape`` is the window's number of
    nodes. Nested loops for each dimension are three times as fast as counting digits.
    """
    nodes, values, gradients = table.nodes, table.weight, table.gradient
    node = 0
    for d in range(len(spacing)):
        node = node * shape[d] + int(base[d])
    node += offset
    width = min(width, WIDEST)
    if len(spacing) == 2:
        for a in range(width):
            for b in range(width):
                entry = np.uint64(k + a * width + b)
                nodes[entry] = node + a * shape[1] + b
                values[entry] = weight[0, a] * weight[1, b]
                if len(gradients) > 0:
                    gradients[entry, 0] = slope[0, a] * weight[1, b]
                    gradients[entry, 1] = weight[0, a] * slope[1, b]
    else:
        for a in range(width):
            for b in range(width):
                n_ab = weight[0, a] * weight[1, b]
                along_a, along_b = slope[0, a] * weight[1, b], weight[0, a] * slope[1, b]
                for c in range(width):
                    entry = np.uint64(k + (a * width + b) * width + c)
                    nodes[entry] = node + (a * shape[1] + b) * shape[2] + c
                    values[entry] = n_ab * weight[2, c]
                    if len(gradients) > 0:
                        gradients[entry, 0] = along_a * weight[2, c]
                        gradients[entry, 1] = along_b * weight[2, c]
                        gradients[entry, 2] = n_ab * slope[2, c]


#: Least weight of the upper node: small against rounding of positions, and enough to carry a velocity.
LEAST_SHARE = 1e-13


@device
def linear_weights(xi: Float, inverse_h: Float, d: int, base: Floats, weight: Floats, slope: Floats) -> None:
    """Linear hat functions of the two nodes round ``xi`` [cells] along axis ``d``.

    A point exactly on a grid line keeps a share of 1e-13 in the next node: its gradient acts there, and a
    node at the edge of a body would otherwise have a gradient but neither mass nor velocity, which reads as
    strain in free flight."""
    base[d] = np.floor(xi)
    fraction = max(xi - base[d], LEAST_SHARE)
    weight[d, 0] = 1.0 - fraction
    weight[d, 1] = fraction
    slope[d, 0] = -inverse_h
    slope[d, 1] = inverse_h


@device
def fits(base: Floats, width: int, shape: Ints, spacing: tuple[float, ...]) -> bool:
    """Return True if nodes ``base`` … ``base + width − 1`` lie in a window of ``shape`` nodes; NaN is not."""
    inside = True
    for d in range(len(spacing)):
        if not (base[d] >= 0.0 and base[d] + width <= shape[d]):
            inside = False
    return inside


@kernel
def fill_linear(position: Floats, first: Ints, grid: Nodes, table: Table, spacing: tuple[float, ...]) -> int:
    """Linear shape functions at points; 2**dim entries each. Return the first point outside its window, or
    −1.

    Points ``first[f]:first[f + 1]`` belong to velocity field ``f``. A gradient of length 0 is not written.
    """
    dim, width, inverse_h = len(spacing), 2, 1.0 / spacing[0]
    origin, shape, base = scratch.vector(spacing), scratch.integers(spacing), scratch.vector(spacing)
    w, s = scratch.matrix(spacing, (0.0, 0.0)), scratch.matrix(spacing, (0.0, 0.0))
    for f in range(len(first) - 1):
        read_window(grid, f, origin, shape, spacing)
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                linear_weights((position[p, d] - origin[d]) * inverse_h, inverse_h, d, base, w, s)
            if not fits(base, width, shape, spacing):
                return p
            fill_tensor_product(p * width**dim, width, base, w, s, shape, grid.offset[f], table, spacing)
    return -1


#: As long as the corners of a domain in three dimensions: the size of scratch arrays with a row for each.
CORNERS = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

#: As long as the row that a corner adds to an entry, φ and ∇φ; in two dimensions the last number is 0.
ENTRY = (0.0, 0.0, 0.0, 0.0)

#: What :func:`fill_domain` returns where a corner lies outside the window, and where the table is too short.
OUTSIDE, FULL = -1, -2


@device
def fill_domain(
    k: int, end: int, corner: Floats, share: Floats, slope: Floats, shape: Ints, offset: int, table: Table,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Write φ_i = Σ_c share_c N_i(x_c) and ∇φ_i = Σ_c slope_c N_i(x_c) from entry ``k`` on; return the entry
    after the last.

    N_i(x) = Π_d max(0, 1 − abs(x_d − i_d)), all in cells. The entries are the nodes of the smallest box that
    holds all that the corners touch: neighbouring corners share most of their nodes, and a row of 4**dim
    entries would be 3 times (2D) or 4 times (3D) as long. ``corner`` (2**dim, dim) is counted from the
    window's first node, ``share`` (2**dim,), ``slope`` (2**dim, dim) [1/m]. Returns ``OUTSIDE`` if a corner
    lies outside the window of ``shape`` nodes or is NaN, ``FULL`` if the row would not end before ``end``;
    then nothing is written."""
    dim = len(spacing)
    lowest, highest = scratch.vector(spacing), scratch.vector(spacing)
    at, terms = scratch.matrix(spacing, CORNERS), scratch.matrix(CORNERS, ENTRY)
    for d in range(dim):
        lowest[d] = highest[d] = corner[0, d]
        for c in range(1, 1 << dim):
            lowest[d], highest[d] = min(lowest[d], corner[c, d]), max(highest[d], corner[c, d])
    for c in range(1 << dim):
        terms[c, 0], terms[c, 3] = share[c], 0.0
        for d in range(dim):
            at[d, c], terms[c, 1 + d] = corner[c, d], slope[c, d]
    return fill_box(k, end, lowest, highest, at, terms, shape, offset, table, spacing)


@device
def fill_parallelepiped(
    k: int, end: int, centre: Floats, half_edges: Floats, inverse: Floats, across: Floats | None, shape: Ints,
    offset: int, table: Table, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """:func:`fill_domain` of corners x_c = centre + R s_c, s_c,e = ±1, with equal shares and slopes
    2^−dim R^−T s_c.

    ``half_edges`` is R (dim, dim) [cells], ``inverse`` its inverse [1/m]. With ``across`` (2,) the slopes
    have s_c,e + s_c,0 s_c,1 across_e instead of s_c,e. All corners are worked out side by side."""
    dim, share = len(spacing), 1.0 / (1 << len(spacing))
    lowest, highest = scratch.vector(spacing), scratch.vector(spacing)
    at, terms = scratch.matrix(spacing, CORNERS), scratch.matrix(CORNERS, ENTRY)
    one, sign = scratch.matrix((0.0,), CORNERS), scratch.matrix(spacing, CORNERS)
    mean, edge = scratch.matrix((0.0,), ENTRY), scratch.matrix(spacing, ENTRY)
    for c in range(len(CORNERS)):
        one[0, c] = 1.0
        for e in range(dim):
            sign[e, c] = 1.0 if (c >> e) & 1 else -1.0
    for d in range(dim):
        reach = 0.0
        set_scaled_row(at, d, centre[d], one, 0, CORNERS)
        for e in range(dim):
            reach += abs(half_edges[d, e])
            add_scaled_row(at, d, half_edges[d, e], sign, e, CORNERS)
        lowest[d], highest[d] = centre[d] - reach, centre[d] + reach
    mean[0, 0], mean[0, 1], mean[0, 2], mean[0, 3] = share, 0.0, 0.0, 0.0
    for e in range(dim):
        edge[e, 0] = edge[e, 3] = 0.0
        for d in range(dim):
            edge[e, 1 + d] = share * inverse[e, d]
    for c in range(1 << dim):
        set_scaled_row(terms, c, 1.0, mean, 0, ENTRY)
        for e in range(dim):
            add_scaled_row(terms, c, sign[e, c], edge, e, ENTRY)
            if across is not None:
                add_scaled_row(terms, c, sign[0, c] * sign[1, c] * across[e], edge, e, ENTRY)
    return fill_box(k, end, lowest, highest, at, terms, shape, offset, table, spacing)


@device
def fill_box(
    k: int, end: int, lowest: Floats, highest: Floats, at: Floats, terms: Floats, shape: Ints, offset: int,
    table: Table, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Write (φ_i, ∇φ_i) = Σ_c N_i(x_c) terms_c of the nodes round the corners, as :func:`fill_domain`.

    ``at`` (dim, 8) are the corners, axis by axis, ``lowest`` and ``highest`` their bounds, and ``terms``
    (8, 4) share and slope."""
    dim = len(spacing)
    low, extent = scratch.integers(spacing), scratch.integers(spacing)
    entries = 1
    for d in range(dim):
        if not (lowest[d] >= 0.0 and highest[d] + 1.0 < shape[d]):
            return OUTSIDE
        low[d] = int(lowest[d])
        extent[d] = math.ceil(highest[d]) - low[d] + 1
        entries *= extent[d]
    if k + entries > end:
        return FULL
    nodes, values, gradients = table.nodes, table.weight, table.gradient
    total = scratch.matrix((0.0,), ENTRY)
    edge, n, one = scratch.vector(CORNERS), scratch.vector(CORNERS), scratch.vector(CORNERS)
    for c in range(1 << dim):
        one[c] = 1.0
    entry = np.uint64(k)
    for plane in range(extent[0] if dim == 3 else 1):
        for j in range(low[dim - 2], low[dim - 2] + extent[dim - 2]):
            first = offset + j * shape[dim - 1]
            multiply_by_hats(edge, one, at, dim - 2, j, spacing)
            if dim == 3:
                i = low[0] + plane
                first += i * shape[1] * shape[2]
                multiply_by_hats(edge, edge, at, 0, i, spacing)
            for l in range(low[dim - 1], low[dim - 1] + extent[dim - 1]):
                multiply_by_hats(n, edge, at, dim - 1, l, spacing)
                set_scaled_row(total, 0, n[0], terms, 0, ENTRY)
                for c in range(1, 1 << dim):
                    add_scaled_row(total, 0, n[c], terms, c, ENTRY)
                nodes[entry] = first + l
                values[entry] = total[0, 0]
                for d in range(dim):
                    gradients[entry, d] = total[0, 1 + d]
                entry += np.uint64(1)
    return k + entries
