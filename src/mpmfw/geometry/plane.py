"""Base of plane bodies."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np
import shapely

from mpmfw.geometry.base import BodyGeometry
from mpmfw.geometry.clipped_lattice import clipped_lattice
from mpmfw.geometry.facets import closed_loop
from mpmfw.geometry.layout import FloatArray, IntArray, Layout


class PlaneGeometry(BodyGeometry):
    """Base of plane bodies: subclasses say their :attr:`region` and :meth:`outlines`, from which the rest
    follows.

    Where the true shape is curved they say its :attr:`exact_volume`, :attr:`centroid` and :attr:`bounds` as
    well.
    """

    dim: ClassVar[int] = 2  #: number of space dimensions

    @property
    @abstractmethod
    def region(self) -> Any:
        """The body as a shapely polygon [m], of the exact area."""

    @property
    def exact_volume(self) -> float:
        """Area of the true shape [m^2]."""
        return float(self.region.area)

    @property
    def centroid(self) -> FloatArray:
        """Centroid of the true shape (2,) [m]."""
        return np.asarray(shapely.get_coordinates(self.region.centroid)[0])

    @property
    def outline_length(self) -> float:
        """Length of all outlines [m]."""
        return float(self.region.length)

    @property
    def bounds(self) -> FloatArray:
        """Lower and upper corner of the bounding box (2, 2) [m]."""
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
        return tuple((loop, closed_loop(len(loop))) for loop in self.outlines(edge))

    @property
    def axes(self) -> FloatArray:
        """Unit vectors along which the body's sides are named, one a row (2, 2)."""
        return np.eye(2)

    @property
    def is_connected(self) -> bool:
        """Whether the body is of one piece."""
        return True

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """Square cells of edge ``size`` [m], shifted by ``offset`` (fractions), clipped by the outline."""
        return clipped_lattice(self.region, size, offset)
