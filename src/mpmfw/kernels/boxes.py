"""Bounding boxes: of bodies, of facets and of blocks of facets."""

from __future__ import annotations

import math

from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels._struct import Struct
from mpmfw.kernels.types import Faceted, Float, Floats, Ints


class Boxes(Struct):
    """Bounding boxes of all bodies."""

    lower: Floats  #: (n_bodies, dim) [m]
    upper: Floats  #: (n_bodies, dim) [m]


@device
def read_box(
    i: int, corners: Ints, position: Floats, lower: Floats, upper: Floats, spacing: tuple[float, ...]
) -> None:
    """Write the bounding box of the surface nodes ``corners[i]`` into ``lower`` and ``upper`` (dim,) [m]."""
    for d in range(len(spacing)):
        lower[d] = upper[d] = position[corners[i, 0], d]
        for a in range(1, corners.shape[1]):
            lower[d] = min(lower[d], position[corners[i, a], d])
            upper[d] = max(upper[d], position[corners[i, a], d])


@device
def square_between(
    lower: Floats, upper: Floats, other_lower: Floats, other_upper: Floats, spacing: tuple[float, ...]
) -> Float:
    """Squared distance of two boxes [m²]."""
    square = 0.0
    for d in range(len(spacing)):
        beyond = max(lower[d] - other_upper[d], other_lower[d] - upper[d], 0.0)
        square += beyond * beyond
    return square


@device
def boxes_apart(a: int, b: int, lower: Floats, upper: Floats, reach: Float) -> bool:
    """Return true if boxes a and b of ``lower`` and ``upper`` (n, dim) are farther apart than ``reach`` [m]
    along an axis."""
    apart = False
    for d in range(lower.shape[1]):
        apart = apart or lower[a, d] - upper[b, d] > reach or lower[b, d] - upper[a, d] > reach
    return apart


#: Consecutive facets that share a bounding box where the closest one is looked for.
BLOCK = 8


@device
def block_boxes(
    first: int, last: int, start: int, surface: Faceted, boxes: Floats, spacing: tuple[float, ...]
) -> None:
    """Bounding boxes of each ``BLOCK`` of the facets ``first:last``, lower and upper corner, into the rows
    of ``boxes`` from ``start`` on."""
    for m in range(first, last):
        row = start + (m - first) // BLOCK
        if (m - first) % BLOCK == 0:
            for d in range(len(spacing)):
                boxes[row, 0, d], boxes[row, 1, d] = math.inf, -math.inf
        for a in range(len(spacing)):
            p = surface.facets[m, a]
            for d in range(len(spacing)):
                boxes[row, 0, d] = min(boxes[row, 0, d], surface.position[p, d])
                boxes[row, 1, d] = max(boxes[row, 1, d], surface.position[p, d])


@kernel
def bounding_boxes(first: Ints, position: Floats, lower: Floats, upper: Floats) -> None:
    """Bounding box of the nodes ``first[b]:first[b + 1]`` of every body b; an empty range gives an empty
    box."""
    for b in range(len(first) - 1):
        for d in range(position.shape[1]):
            low, high = math.inf, -math.inf
            for s in range(first[b], first[b + 1]):
                low = min(low, position[s, d])
                high = max(high, position[s, d])
            lower[b, d], upper[b, d] = low, high
