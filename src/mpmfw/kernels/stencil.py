"""Filling interpolation tables: tensor products of one-dimensional weights."""

from __future__ import annotations

import math

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.types import Float, Floats, Indices, Ints


@device
def cell_coordinate(x: Float, lower: Float, window_lower: Float, h: Float) -> Float:
    """Position in cells, counted from the first node of the velocity field's window."""
    return (x - lower) / h - window_lower


@device
def fill_tensor_product(
    k: int,
    width: int,
    base: Floats,
    weight: Floats,
    slope: Floats,
    shape: Ints,
    offset: int,
    nodes: Indices,
    values: Floats,
    gradients: Floats,
    spacing: tuple[float, ...],
) -> None:
    """Write the ``width**dim`` entries of one point from ``k`` on.

    N = Π_d w_d and ∂N/∂x_e = w'_e Π_{d≠e} w_d, where ``weight[d, a]`` is w_d of node ``base[d] + a`` and ``slope`` its
    derivative [1/m]. ``gradients`` of length 0 are not written. ``shape`` is the window's number of nodes. The nested loops
    are written out for each dimension: this is the one place where that is three times as fast as counting digits.
    """
    node = 0
    for d in range(len(spacing)):
        node = node * shape[d] + int(base[d])
    node += offset
    if len(spacing) == 2:
        for a in range(width):
            for b in range(width):
                nodes[k] = node + a * shape[1] + b
                values[k] = weight[0, a] * weight[1, b]
                if len(gradients) > 0:
                    gradients[k, 0] = slope[0, a] * weight[1, b]
                    gradients[k, 1] = weight[0, a] * slope[1, b]
                k += 1
    else:
        for a in range(width):
            for b in range(width):
                for c in range(width):
                    nodes[k] = node + (a * shape[1] + b) * shape[2] + c
                    values[k] = weight[0, a] * weight[1, b] * weight[2, c]
                    if len(gradients) > 0:
                        gradients[k, 0] = slope[0, a] * weight[1, b] * weight[2, c]
                        gradients[k, 1] = weight[0, a] * slope[1, b] * weight[2, c]
                        gradients[k, 2] = weight[0, a] * weight[1, b] * slope[2, c]
                    k += 1


@device
def fill_corner(
    k: int,
    corner: Floats,
    share: Float,
    slope: Floats,
    lower: Floats,
    window_lower: Ints,
    shape: Ints,
    offset: int,
    nodes: Indices,
    values: Floats,
    gradients: Floats,
    spacing: tuple[float, ...],
) -> bool:
    """Write the 2**dim entries of one corner of a particle's domain: weight ``share`` N_i and gradient ``slope`` N_i.

    Return whether the corner lies in the window; nothing is written if not.
    """
    dim = len(spacing)
    fraction = scratch.vector(spacing)
    node = 0
    inside = True
    for d in range(dim):
        xi = cell_coordinate(corner[d], lower[d], window_lower[d], spacing[d])
        cell = math.floor(xi)
        fraction[d] = xi - cell
        inside = inside and cell >= 0.0 and cell + 2 <= shape[d]
        node = node * shape[d] + int(cell)
    if inside:
        node += offset
        for entry in range(2**dim):
            index = 0
            n = 1.0
            for d in range(dim):
                bit = (entry >> (dim - 1 - d)) & 1
                index = index * shape[d] + bit
                n *= fraction[d] if bit else 1.0 - fraction[d]
            nodes[k + entry] = node + index
            values[k + entry] = share * n
            for d in range(dim):
                gradients[k + entry, d] = slope[d] * n
    return inside


@device
def linear_weights(xi: Float, inverse_h: Float, d: int, base: Floats, weight: Floats, slope: Floats) -> None:
    """Linear hat functions of the two nodes round ``xi`` [cells] along axis ``d``."""
    base[d] = math.floor(xi)
    fraction = xi - base[d]
    weight[d, 0] = 1.0 - fraction
    weight[d, 1] = fraction
    slope[d, 0] = -inverse_h
    slope[d, 1] = inverse_h


@device
def fits(base: Floats, width: int, shape: Ints, spacing: tuple[float, ...]) -> bool:
    """Whether nodes ``base`` … ``base + width − 1`` lie in a window of ``shape`` nodes; false for NaN."""
    inside = True
    for d in range(len(spacing)):
        if not (base[d] >= 0.0 and base[d] + width <= shape[d]):
            inside = False
    return inside


@kernel
def fill_linear(
    position: Floats,
    first: Ints,
    lower: Floats,
    window_lower: Ints,
    window_shape: Ints,
    offset: Ints,
    nodes: Indices,
    weight: Floats,
    gradient: Floats,
    spacing: tuple[float, ...],
) -> int:
    """Linear shape functions at points; 2**dim entries each. Return the first point outside its window, or −1.

    Points ``first[f]:first[f + 1]`` belong to velocity field ``f``. A ``gradient`` of length 0 is not written.
    """
    dim = len(spacing)
    width = 2
    base = scratch.vector(spacing)
    w = scratch.matrix(spacing, (0.0, 0.0))
    s = scratch.matrix(spacing, (0.0, 0.0))
    for f in range(len(first) - 1):
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                xi = cell_coordinate(position[p, d], lower[d], window_lower[f, d], spacing[d])
                linear_weights(xi, 1.0 / spacing[d], d, base, w, s)
            if not fits(base, width, window_shape[f], spacing):
                return p
            fill_tensor_product(
                p * width**dim, width, base, w, s, window_shape[f], offset[f], nodes, weight, gradient, spacing
            )
    return -1
