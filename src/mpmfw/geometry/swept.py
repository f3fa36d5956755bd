"""Surfaces of triangles swept by an outline: along a straight line, and round an axis."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from mpmfw.geometry.layout import FloatArray, IntArray
from mpmfw.geometry.plane_triangles import plane_triangles
from mpmfw.geometry.polylines import number_of_segments

#: Fewest nodes on a ring round the axis.
FEWEST = 6


def extruded_surface(
    loops: tuple[FloatArray, ...], low: float, high: float, edge: float
) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 3) [m] and triangles (k, 3) of a prism along z from ``low`` to ``high`` [m].

    Parameters
    ----------
    loops : tuple of (m, 2)
        Closed polylines of the base [m], the material on their left, segments up to ``edge`` [m].
    """
    plane, cap = plane_triangles(loops, edge)
    rim = sum(len(loop) for loop in loops)
    layers = number_of_segments(high - low, edge)
    inner = np.arange(1, layers) / layers
    heights = low + (high - low) * inner
    nodes = [np.column_stack([plane, np.full(len(plane), z)]) for z in (low, high)]
    nodes += [np.column_stack([plane[:rim], np.full(rim, z)]) for z in heights]
    # the first node of every ring: the base, the rings between, the top
    start = np.array(
        [0, *(2 * len(plane) + rim * np.arange(layers - 1)), len(plane)] if layers else [0, len(plane)]
    )
    facets = [cap[:, ::-1], cap + len(plane)]
    first = 0
    for loop in loops:
        here = first + np.arange(len(loop))
        after = first + (np.arange(len(loop)) + 1) % len(loop)
        for below, above in pairwise(start.tolist()):
            facets += [np.stack([below + here, below + after, above + after], axis=1)]
            facets += [np.stack([below + here, above + after, above + here], axis=1)]
        first += len(loop)
    return np.concatenate(nodes), np.concatenate(facets)


def revolved_surface(loop: FloatArray, edge: float) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 3) [m] and triangles (k, 3) of what a closed polyline encloses when it turns about z.

    Parameters
    ----------
    loop : (m, 2)
        Distance from the axis, not negative, and height [m], the material on the left. Where two nodes in a
        row lie on the axis, so does the segment between them, and it sweeps nothing.
    """
    rings, nodes, total = [], [], 0
    on_axis = loop[:, 0] == 0.0
    idle = on_axis & np.roll(on_axis, 1) & np.roll(on_axis, -1)  # within a segment on the axis
    for radius, height in loop[~idle]:
        if radius == 0.0:
            angle = np.zeros(1)
        else:
            n = max(FEWEST, 4 * number_of_segments(0.5 * np.pi * radius, edge))
            angle = 2.0 * np.pi * np.arange(n) / n
        rings.append((total, angle))
        nodes.append(
            np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(len(angle), height)], axis=1)
        )
        total += len(angle)
    facets = [_strip(one, other) for one, other in zip(rings, [*rings[1:], rings[0]], strict=True)]
    return np.concatenate(nodes), np.concatenate(facets)


def _strip(one: tuple[int, FloatArray], other: tuple[int, FloatArray]) -> IntArray:
    """Triangles (k, 3) between two rings, each given by its first node and the angles of all: from node to
    node of either, by the angle of the side's middle."""
    (start, angles), (begin, others) = one, other
    n, m = len(angles), len(others)
    if n == m == 1:
        return np.empty((0, 3), dtype=np.int64)
    steps = [(2.0 * np.arange(k) + 1.0) / k if k > 1 else np.empty(0) for k in (n, m)]
    order = np.argsort(np.concatenate(steps), kind="stable")
    on_first = order < len(steps[0])
    here: IntArray = np.cumsum(on_first) - on_first
    there: IntArray = np.cumsum(~on_first) - ~on_first
    third = np.where(on_first, start + (here + 1) % n, begin + (there + 1) % m)
    return np.stack([start + here % n, third, begin + there % m], axis=1).astype(np.int64)
