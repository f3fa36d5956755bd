"""Bounding boxes of surfaces, the facet that is closest to a point, and the least gap between bodies."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.kernels import scratch
from mpmfw.kernels._jit import device, kernel
from mpmfw.kernels.facets import Faceted, read_corners, read_point, signed_distance, squared_distance
from mpmfw.kernels.types import Float, Floats, Ints

#: Consecutive facets that share a bounding box where the closest one is looked for.
BLOCK = 8


@device
def block_boxes(
    first: int, last: int, start: int, surface: Faceted, boxes: Floats, spacing: tuple[float, ...]
) -> None:
    """Bounding boxes of each ``BLOCK`` of the facets ``first:last``, lower and upper corner, into the rows of
    ``boxes`` from ``start`` on."""
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


@device
def box_distance(x: Floats, row: int, boxes: Floats, spacing: tuple[float, ...]) -> Float:
    """Squared distance of a point from a box, lower corner ``boxes[row, 0]`` and upper ``boxes[row, 1]``
    [m²], 0 inside.
    """
    square = 0.0
    for d in range(len(spacing)):
        beyond = max(boxes[row, 0, d] - x[d], x[d] - boxes[row, 1, d], 0.0)
        square += beyond * beyond
    return square


@device
def closest_facet(
    x: Floats, within: Float, guess: int, first: int, last: int, start: int, surface: Faceted, boxes: Floats,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Of the facets ``first:last`` that closest to a point, of equally close ones the first; −1 if none is
    near.

    ``boxes`` are from row ``start`` on those of the facets' blocks (:func:`block_boxes`), ``within`` is the
    square of the distance from which on they are of no interest [m²]. Only blocks are looked through whose
    box is not farther than that, or than what was found; the block of ``guess`` is the first."""
    corners = scratch.matrix(spacing, spacing)
    nearest, closest, size = within, -1, 0.0
    for d in range(len(spacing)):
        size += x[d] * x[d]
    blocks = (last - first + BLOCK - 1) // BLOCK
    for visit in range(-1, blocks):
        block = (guess - first) // BLOCK if visit < 0 else visit
        box = box_distance(x, start + block, boxes, spacing)
        # The allowances are beyond rounding: no facet is passed over that the arithmetic would find closer.
        if box > nearest * (1.0 + 1e-9) + 1e-24 * size:
            continue
        for m in range(first + block * BLOCK, min(first + (block + 1) * BLOCK, last)):
            read_corners(m, surface.position, surface.facets, corners, spacing)
            square = squared_distance(x, corners, spacing)
            if square < nearest or (square == nearest and (closest < 0 or m < closest)):
                nearest, closest = square, m
    return closest


@device
def turns_round(x: Floats, first: int, last: int, surface: Faceted) -> int:
    """How often the closed polyline of segments ``first:last`` goes round a point of the plane,
    counter-clockwise.

    That is 1 inside a body and 0 outside, whatever its corners do.
    """
    turns = 0
    for m in range(first, last):
        p, q = surface.facets[m, 0], surface.facets[m, 1]
        below, then = surface.position[p, 1] <= x[1], surface.position[q, 1] <= x[1]
        if below != then:
            left = (surface.position[q, 0] - surface.position[p, 0]) * (x[1] - surface.position[p, 1])
            left -= (x[0] - surface.position[p, 0]) * (surface.position[q, 1] - surface.position[p, 1])
            # A line upwards has the point on its left, or one downwards on its right
            if below and left > 0.0:
                turns += 1
            elif then and left < 0.0:
                turns -= 1
    return turns


@device
def least_gap(
    first_a: int, last_a: int, first_b: int, last_b: int, start: int, least: Float, surface: Faceted,
    boxes: Floats,
    spacing: tuple[float, ...],
) -> Float:  # fmt: skip
    """``least``, or the least signed distance of nodes ``first_a:last_a`` from the facets ``first_b:last_b``
    [m] if less.

    ``boxes`` are from row ``start`` on those of the facets' blocks, and behind them is room for one more. The
    node that is closest to the box round them all goes first: most others turn out to be farther from that
    box than the distance then found."""
    dim = len(spacing)
    x, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    blocks = (last_b - first_b + BLOCK - 1) // BLOCK
    whole = start + blocks
    for d in range(dim):
        boxes[whole, 0, d], boxes[whole, 1, d] = math.inf, -math.inf
    for block in range(start, start + blocks):
        for d in range(dim):
            boxes[whole, 0, d] = min(boxes[whole, 0, d], boxes[block, 0, d])
            boxes[whole, 1, d] = max(boxes[whole, 1, d], boxes[block, 1, d])
    nearest, shortest = first_a, math.inf
    for s in range(first_a, last_a):
        read_point(s, surface.position, x, spacing)
        box = box_distance(x, whole, boxes, spacing)
        if box < shortest:
            nearest, shortest = s, box
    closest = first_b
    for visit in range(first_a - 1, last_a):
        s = nearest if visit < first_a else visit
        read_point(s, surface.position, x, spacing)
        box = box_distance(x, whole, boxes, spacing)
        square = max(least, 0.0) * max(least, 0.0)
        if box > square:
            # farther from the whole surface's box than the least distance, or outside where another is inside
            continue
        # What is within the box may be inside, and deeper than the least distance found.
        within = square * (1.0 + 1e-9) if box > 0.0 else math.inf
        m = closest_facet(x, within, closest, first_b, last_b, start, surface, boxes, spacing)
        if m >= 0:
            closest = m
            gap = signed_distance(x, m, surface, share, normal, spacing)
            # Where a corner is folded over normals do not tell inside from outside
            if gap < min(least, 0.0) and dim == 2 and turns_round(x, first_b, last_b, surface) <= 0:
                gap = -gap
            least = min(least, gap)
    return least


@kernel
def minimum_gap(
    first_a: int, last_a: int, first_b: int, last_b: int, surface: Faceted, spacing: tuple[float, ...]
) -> float:
    """Least signed distance of nodes ``first_a:last_a`` from the facets ``first_b:last_b`` [m].

    Each node counts with its closest facet; the least over the nodes is negative as soon as one is inside.
    """
    boxes = np.empty(((last_b - first_b) // BLOCK + 2, 2, len(spacing)))
    block_boxes(first_b, last_b, 0, surface, boxes, spacing)
    least: float = least_gap(first_a, last_a, first_b, last_b, 0, math.inf, surface, boxes, spacing)
    return least


@kernel
def minimum_gaps(
    first: Ints,
    second: Ints,
    body_first: Ints,
    facet_first: Ints,
    surface: Faceted,
    gaps: Floats,
    spacing: tuple[float, ...],
) -> None:
    """Least distance of the surfaces of every two bodies ``first`` and ``second``, into ``gaps`` [m].

    The lesser of both ways of :func:`mpmfw.kernels.minimum_gap`, of the nodes of one from the facets of the
    other. The nodes of body b are ``body_first[b]:body_first[b + 1]``, its facets
    ``facet_first[b]:facet_first[b + 1]``."""
    n_bodies = len(body_first) - 1
    boxes = np.empty((facet_first[n_bodies] // BLOCK + 2 * n_bodies, 2, len(spacing)))
    for b in range(n_bodies):
        start = facet_first[b] // BLOCK + 2 * b
        block_boxes(facet_first[b], facet_first[b + 1], start, surface, boxes, spacing)
    for c in range(len(first)):
        least = math.inf
        for way in range(2):
            a, b = (first[c], second[c]) if way == 0 else (second[c], first[c])
            least = least_gap(
                body_first[a], body_first[a + 1], facet_first[b], facet_first[b + 1],
                facet_first[b] // BLOCK + 2 * b,
                least, surface, boxes, spacing,
            )  # fmt: skip
        gaps[c] = least


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
