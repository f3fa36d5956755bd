"""Base of plane bodies."""

from __future__ import annotations

import math
from abc import abstractmethod
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import shapely

from mpmfw.geometry.base import BodyGeometry
from mpmfw.geometry.clipped_lattice import clipped_lattice
from mpmfw.geometry.layout import FloatArray, IntArray, Layout


class PlaneGeometry(BodyGeometry):
    """Base of plane bodies: subclasses give their :attr:`region` and :meth:`outlines`.

    Where the true shape is curved they give its :attr:`exact_volume`, :attr:`centroid` and :attr:`bounds`.
    """

    dim: ClassVar[int] = 2  #: number of space dimensions

    @property
    @abstractmethod
    def region(self) -> Any:
        """The body as a shapely polygon [m], of the exact area."""

    @property
    def exact_volume(self) -> float:
        return float(self.region.area)

    @property
    def centroid(self) -> FloatArray:
        return np.asarray(shapely.get_coordinates(self.region.centroid)[0])

    @property
    def outline_length(self) -> float:
        """Length of all outlines [m]."""
        return float(self.region.length)

    @cached_property
    def bounds(self) -> FloatArray:
        return np.reshape(self.region.bounds, (2, 2))

    @property
    def width(self) -> float:
        """Short side of the least rectangle round the body, however it is turned [m]."""
        corners = shapely.get_coordinates(shapely.oriented_envelope(self.region))
        return float(np.linalg.norm(np.diff(corners, axis=0), axis=1).min())

    @abstractmethod
    def outlines(self, segment: float) -> tuple[FloatArray, ...]:
        """Closed polylines (m, 2) [m] on the true outline, with segments no longer than ``segment`` [m]."""

    def surfaces(self, edge: float) -> tuple[tuple[FloatArray, IntArray], ...]:
        """Nodes (m, 2) [m] and segments (m, 2) of every outline, the segments no longer than ``edge`` [m]."""
        loops = [(loop, np.arange(len(loop))) for loop in self.outlines(edge)]
        return tuple((loop, np.stack([node, np.roll(node, -1)], axis=1)) for loop, node in loops)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        return clipped_lattice(self.region, size, offset)


# Nodes of the polygon by which discs and rings are clipped: it departs from the circle by 4e-7 of the radius
CLIPPING_NODES = 4096


def number_of_segments(length: float, segment: float) -> int:
    """Least number of equal segments of at most ``segment`` [m] in ``length`` [m], deaf to round-off."""
    return max(1, math.ceil(length / segment - 1e-9))


def circle_nodes(centre: tuple[float, float], radius: float, n: int) -> FloatArray:
    """``n`` nodes (n, 2) [m] on a circle, counter-clockwise, the first at angle 0."""
    angle = 2 * np.pi * np.arange(n) / n
    return np.asarray(np.array(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)]))


def circle_outline(centre: tuple[float, float], radius: float, segment: float) -> FloatArray:
    """Nodes (n, 2) [m] on the true circle, n = 4 ceil(2 π radius/(4 segment)): it keeps the mirror planes."""
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
