"""Closed polylines that stand for outlines."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely

from mpmfw.geometry.layout import FloatArray

# Nodes of the polygon by which discs and rings are clipped: it departs from the circle by 4e-7 of the radius
CLIPPING_NODES = 4096


def number_of_segments(length: float, segment: float) -> int:
    """Least number of equal segments of at most ``segment`` [m] in ``length`` [m], deaf to round-off."""
    return max(1, math.ceil(length / segment - 1e-9))


def circle_nodes(centre: tuple[float, float], radius: float, n: int) -> FloatArray:
    """``n`` nodes (n, 2) [m] on a circle, counter-clockwise, the first at angle 0.

    For even ``n`` they are mirror images of one another about both axes through the centre, for multiples of
    four about the diagonals too.
    """
    angle = 2 * np.pi * np.arange(n) / n
    nodes: FloatArray = np.array(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    return nodes


def circle_outline(centre: tuple[float, float], radius: float, segment: float) -> FloatArray:
    """Nodes (n, 2) [m] on the true circle, n = 4 ceil(2 π radius/(4 segment)) equal segments.

    A multiple of four: the outline has the circle's mirror planes along axes and diagonals.
    """
    return circle_nodes(centre, radius, 4 * number_of_segments(0.5 * np.pi * radius, segment))


def equal_area_factor(n: int) -> float:
    """Radius of the regular n-gon of a circle's area over the circle's: sqrt(x/sin x), x = 2 π/n."""
    return math.sqrt((2 * np.pi / n) / math.sin(2 * np.pi / n))


def clipping_circle(centre: tuple[float, float], radius: float) -> FloatArray:
    """A fine polygon (n, 2) [m] with the exact area of the disc."""
    return circle_nodes(centre, radius * equal_area_factor(CLIPPING_NODES), CLIPPING_NODES)


def subdivided(corners: FloatArray, segment: float) -> FloatArray:
    """A closed polyline (m, 2) [m]: corners (k, 2) kept, edges in equal segments of at most ``segment``."""
    pieces = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        n = number_of_segments(float(np.hypot(*(end - start))), segment)
        pieces.append(start + (end - start) * (np.arange(n) / n)[:, np.newaxis])
    return np.concatenate(pieces)


def loops_of(region: Any) -> tuple[FloatArray, ...]:
    """Rings (k, 2) [m] of a shapely polygon: the outer one counter-clockwise, holes clockwise."""
    oriented = shapely.geometry.polygon.orient(region, 1.0)
    return tuple(shapely.get_coordinates(ring)[:-1] for ring in (oriented.exterior, *oriented.interiors))
