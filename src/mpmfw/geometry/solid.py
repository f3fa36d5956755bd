"""Base of solid bodies, and their lattice: cubic cells cut by their surface."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from mpmfw.geometry.base import BodyGeometry
from mpmfw.geometry.clipped_lattice import SMALLEST_PIECE, covering_cells, merge_small_pieces
from mpmfw.geometry.cut_cells import centroid_of, cut_cells, volume_of
from mpmfw.geometry.layout import FloatArray, IntArray, Layout, layout_of_boxes, measures_of
from mpmfw.units import Angle

#: Edge of the triangles by which the cells are cut, over that of a cell, where the body's faces are curved.
CUTTING_EDGE = 0.5

Axis = Literal["x", "y", "z"]
Turns = Annotated[tuple[Angle, Angle, Angle], Field(min_length=3, max_length=3)]
Surfaces = tuple[tuple[FloatArray, IntArray], ...]


class SolidGeometry(BodyGeometry):
    """Base of bodies in space: subclasses give their :meth:`surfaces` and ``bounds``.

    Where these have a formula they give :attr:`exact_volume` and :attr:`centroid` as well.
    """

    dim: ClassVar[int] = 3  #: number of space dimensions
    #: Whether the surface of triangles is that of the body itself, however large they are.
    has_plane_faces: ClassVar[bool] = False

    @abstractmethod
    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] and triangles (k, 3), counter-clockwise as seen from outside, of every closed
        surface, sides up to ``edge`` [m]; holes are separate surfaces."""

    @cached_property
    def fine_surface(self) -> tuple[FloatArray, IntArray]:
        """Nodes (n, 3) [m] and triangles (k, 3) so fine that they stand for the body."""
        extent = float(np.ptp(self.bounds, axis=0).max())
        return joined(self.surfaces(extent if self.has_plane_faces else extent / 60.0))

    @property
    def exact_volume(self) -> float:
        return volume_of(*self.fine_surface)

    @property
    def centroid(self) -> FloatArray:
        return centroid_of(*self.fine_surface)

    @property
    def area(self) -> float:
        """Area of the surface [m^2]."""
        return float(measures_of(*self.fine_surface).sum())

    @property
    def width(self) -> float:
        """Smallest extent along the surface's principal axes or the body's own [m]."""
        nodes = self.fine_surface[0]
        principal = np.linalg.eigh(np.cov(nodes.T))[1].T
        return float(min(np.ptp(nodes @ axes.T, axis=0).min() for axes in (principal, self.axes)))

    def surface_nodes(self, edge: float) -> float:
        """Most nodes that the surfaces have with sides up to ``edge`` [m]."""
        return 8.0 * self.area / edge**2 + 40.0

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """Cubic cells of edge ``size`` [m], shifted by ``offset`` (fractions), cut by the surface.

        A particle has the volume and the centroid of its part of a cell, and a cubic domain of that volume.
        Parts below a quarter of a cell join the neighbour with which they share the largest face. Of a curved
        body the surface of fine triangles is stretched about the centroid until it has the true volume.
        """
        nodes, facets = joined(self.surfaces(size if self.has_plane_faces else CUTTING_EDGE * size))
        if not self.has_plane_faces:
            stretch = np.cbrt(self.exact_volume / volume_of(nodes, facets))
            nodes = self.centroid + stretch * (nodes - self.centroid)
        return solid_lattice(nodes, facets, size, offset)


class TurnedSolid(SolidGeometry):
    """Base of solids turned by ``angles`` [rad] about x, then y, then z; their sides turn with them."""

    angles: Turns = (0.0, 0.0, 0.0)

    @property
    def axes(self) -> FloatArray:
        return turning(self.angles).T

    def turned(self, points: FloatArray) -> FloatArray:
        """Points (n, 3) [m] turned about the centroid."""
        if not any(self.angles):
            return points
        return np.asarray(self.centroid + (points - self.centroid) @ turning(self.angles).T)


class AxialSolid(TurnedSolid):
    """Base of solids that stand along an axis before they are turned."""

    axis: Axis = "z"

    @property
    def turn(self) -> FloatArray:
        """Matrix (3, 3) from the body's own frame, in which its axis is z."""
        return np.asarray(turning(self.angles) @ upright(self.axis))


def joined(surfaces: Surfaces) -> tuple[FloatArray, IntArray]:
    """Nodes and triangles of all surfaces as one."""
    first = np.cumsum([0, *(len(nodes) for nodes, _ in surfaces)])
    facets = [facets + start for (_, facets), start in zip(surfaces, first, strict=False)]
    return np.concatenate([nodes for nodes, _ in surfaces]), np.concatenate(facets)


def turning(angles: Turns) -> FloatArray:
    """Matrix (3, 3) of the turns by these angles [rad] about x, then y, then z, axes that stay."""
    matrix = np.eye(3)
    for axis, angle in enumerate(angles):
        one, (e, f) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
        one[e, e] = one[f, f] = np.cos(angle)
        one[f, e], one[e, f] = np.sin(angle), -np.sin(angle)
        matrix = one @ matrix
    return matrix


def upright(axis: Axis) -> FloatArray:
    """Matrix (3, 3) of the turn that brings z to the axis named."""
    return np.roll(np.eye(3), "xyz".index(axis) + 1, axis=0)


def solid_lattice(nodes: FloatArray, facets: IntArray, size: float, offset: tuple[float, ...]) -> Layout:
    """Cut cubic cells by a closed surface; see :meth:`SolidGeometry.lattice`."""
    cells = covering_cells(np.array([nodes.min(axis=0), nodes.max(axis=0)]), size, offset)
    cuts = cut_cells(((nodes - cells.origin) / size)[facets], cells.counts)
    index = np.argwhere(cuts.volume > 1e-9)
    at = tuple(index.T)
    volume = cuts.volume[at]
    centroid = cuts.moment[at] / volume[:, np.newaxis]
    small = np.flatnonzero(volume < SMALLEST_PIECE)
    shared = np.stack(
        [
            np.pad(faces, [(0, int(a == axis)) for a in range(3)])[
                tuple((index[small] + side * (np.arange(3) == axis)).T)
            ]
            for axis, faces in enumerate(cuts.faces)
            for side in (0, 1)
        ],
        axis=1,
    )
    volume, centroid = merge_small_pieces(index, volume, centroid, small, shared, SMALLEST_PIECE)
    edges = np.repeat(size * np.cbrt(volume)[:, np.newaxis], 3, axis=1)
    return layout_of_boxes(cells.origin + size * centroid, edges)
