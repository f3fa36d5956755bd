"""Filling interpolation tables: tensor products of one-dimensional weights."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.types import Float, Floats, Indices, Ints


@device
def read_window(
    lower: Floats,
    window_lower: Ints,
    window_shape: Ints,
    f: int,
    origin: Floats,
    shape: Ints,
    spacing: tuple[float, ...],
) -> None:
    """Position of the first node of velocity field ``f``'s window [m] and its number of nodes, kept on the
    stack.

    There the compiler knows that writing to the table does not change them.
    """
    for d in range(len(spacing)):
        origin[d] = lower[d] + window_lower[f, d] * spacing[d]
        shape[d] = window_shape[f, d]


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

    N = Π_d w_d and ∂N/∂x_e = w'_e Π_{d≠e} w_d, where ``weight[d, a]`` is w_d of node ``base[d] + a`` and
    ``slope`` its derivative [1/m]. ``gradients`` of length 0 are not written. ``shape`` is the window's
    number of nodes. The nested loops are written out for each dimension: this is the one place where that is
    three times as fast as counting digits.
    """
    node = 0
    for d in range(len(spacing)):
        node = node * shape[d] + int(base[d])
    node += offset
    if len(spacing) == 2:
        for a in range(width):
            for b in range(width):
                entry = np.uint64(k + a * width + b)
                nodes[entry] = node + a * shape[1] + b
                values[entry] = weight[0, a] * weight[1, b]
        if len(gradients) > 0:
            for a in range(width):
                for b in range(width):
                    entry = np.uint64(k + a * width + b)
                    gradients[entry, 0] = slope[0, a] * weight[1, b]
                    gradients[entry, 1] = weight[0, a] * slope[1, b]
    else:
        for a in range(width):
            for b in range(width):
                n_ab, along_a, along_b = (
                    weight[0, a] * weight[1, b],
                    slope[0, a] * weight[1, b],
                    weight[0, a] * slope[1, b],
                )
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
    base[d] = math.floor(xi)
    fraction = max(xi - base[d], LEAST_SHARE)
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
    """Linear shape functions at points; 2**dim entries each. Return the first point outside its window, or
    −1.

    Points ``first[f]:first[f + 1]`` belong to velocity field ``f``. A ``gradient`` of length 0 is not
    written.
    """
    dim = len(spacing)
    width = 2
    inverse_h = 1.0 / spacing[0]
    origin = scratch.vector(spacing)
    shape = scratch.integers(spacing)
    base = scratch.vector(spacing)
    w = scratch.matrix(spacing, (0.0, 0.0))
    s = scratch.matrix(spacing, (0.0, 0.0))
    for f in range(len(first) - 1):
        read_window(lower, window_lower, window_shape, f, origin, shape, spacing)
        start = offset[f]
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                xi = (position[p, d] - origin[d]) * inverse_h
                linear_weights(xi, inverse_h, d, base, w, s)
            if not fits(base, width, shape, spacing):
                return p
            fill_tensor_product(
                p * width**dim, width, base, w, s, shape, start, nodes, weight, gradient, spacing
            )
    return -1
