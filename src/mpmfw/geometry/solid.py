"""Solid bodies: their base, ball and box, and their lattice, cubic cells cut by their surface."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from functools import cached_property
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from mpmfw.geometry.base import BodyGeometry, Cornered, Point3D, Round
from mpmfw.geometry.clipped_lattice import SMALLEST_PIECE, covering_cells, merge_small_pieces, tiling
from mpmfw.geometry.cut_cells import centroid_of, cut_cells, volume_of
from mpmfw.geometry.layout import FloatArray, IntArray, Layout, layout_of_boxes, measures_of
from mpmfw.geometry.plane import number_of_segments
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


class Ball(Round, SolidGeometry):
    """A full sphere [m]."""

    type: Literal["ball"] = "ball"
    centre: Point3D

    @property
    def exact_volume(self) -> float:
        return float(4 / 3 * np.pi * self.radius**3)

    @property
    def area(self) -> float:
        return float(4 * np.pi * self.radius**2)

    def surfaces(self, edge: float) -> Surfaces:
        return (sphere_surface(self.centroid, self.radius, edge),)


class Box(Cornered, TurnedSolid):
    """A cuboid between two corners [m], turned about its centre by ``angles`` [rad]."""

    has_plane_faces: ClassVar[bool] = True

    type: Literal["box"] = "box"
    lower: Point3D
    upper: Point3D

    @property
    def bounds(self) -> FloatArray:
        if not any(self.angles):
            return np.array([self.lower, self.upper])
        half = np.abs(turning(self.angles)) @ (0.5 * np.subtract(self.upper, self.lower))
        return np.array([self.centroid - half, self.centroid + half])

    def surfaces(self, edge: float) -> Surfaces:
        """Nodes (n, 3) [m] and triangles (k, 3): rectangles of sides up to ``edge`` [m], cut in four."""
        nodes, facets = box_surface(np.array(self.lower), np.array(self.upper), edge)
        return ((self.turned(nodes), facets),)

    def lattice(self, size: float, offset: tuple[float, ...]) -> Layout:
        """The tiling, shifted by ``offset`` (fractions of a cell), or cut cells where the box is turned."""
        if any(self.angles):
            return super().lattice(size, offset)
        return tiling(self.lower, self.upper, size, offset)

    def fitted(self, size: float) -> Layout:
        cells = tiling(self.lower, self.upper, size, (0.0, 0.0, 0.0))
        if not any(self.angles):
            return cells
        half_edges = turning(self.angles) @ cells.half_edges
        return replace(cells, position=self.turned(cells.position), half_edges=half_edges)


#: Largest stretch of an icosahedron's face that is projected on the sphere, at its centre.
STRETCH = 1.26


def box_surface(lower: FloatArray, upper: FloatArray, edge: float) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 3) [m] and triangles (k, 3) of a cuboid: rectangles of sides up to ``edge`` cut in four.

    The surface has the cuboid's mirror planes, and a load that every triangle's corners share equally is that
    of bilinear functions on a rectangle. Cut in two, its corners would have unequal shares.
    """
    count = np.array([number_of_segments(length, edge) for length in upper - lower])
    places: list[IntArray] = []
    triangles: list[IntArray] = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        i, j = (2 * index.ravel() for index in np.meshgrid(*map(np.arange, count[[u, v]]), indexing="ij"))
        for side in (0, 2 * int(count[axis])):
            # in halves of a rectangle: four corners, and the centre
            quad = np.full((len(i), 5, 3), side, dtype=np.int64)
            quad[:, :, u] = np.stack([i, i + 2, i + 2, i, i + 1], axis=1)
            quad[:, :, v] = np.stack([j, j, j + 2, j + 2, j + 1], axis=1)
            start = 5 * np.arange(len(i))[:, np.newaxis] + sum(len(one) for one in places)
            turn = 1 if side else -1
            triangles += [start + np.array([k, (k + turn) % 4, 4]) for k in range(4)]
            places.append(quad.reshape(-1, 3))
    index, joined = np.unique(np.concatenate(places), axis=0, return_inverse=True)
    share = index / (2 * count)
    return lower * (1.0 - share) + upper * share, joined.ravel()[np.concatenate(triangles)].astype(np.int64)


def sphere_surface(centre: FloatArray, radius: float, edge: float) -> tuple[FloatArray, IntArray]:
    """Nodes (n, 3) [m] on a sphere and triangles (k, 3) up to ``edge``: an icosahedron, divided.

    The surface has the mirror planes of the axes, and less than the ball's volume by the order (edge / R)².
    """
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    corners = np.array([[0.0, a, b * golden] for a in (-1.0, 1.0) for b in (-1.0, 1.0)])
    corners = np.concatenate([np.roll(corners, turn, axis=1) for turn in range(3)])
    apart = np.linalg.norm(corners[:, np.newaxis] - corners, axis=2)
    near = (apart > 0.0) & (apart < 2.0 + 1e-9)
    triples = ((a, b, c) for a in range(12) for b in range(a) for c in range(b))
    faces = [(a, b, c) for a, b, c in triples if near[a, b] and near[b, c] and near[a, c]]
    division = number_of_segments(STRETCH * 2.0 * radius / float(np.linalg.norm(corners[0])), edge)
    share, pieces = _division(division)
    points: list[FloatArray] = []
    triangles: list[IntArray] = []
    for face in faces:
        a, b, c = corners[list(face)]
        outward = np.linalg.det([a, b, c]) > 0.0
        triangles.append(len(points) * len(share) + (pieces if outward else pieces[:, ::-1]))
        points.append(share @ np.array([a, b, c]))
    places = np.concatenate(points)
    places /= np.linalg.norm(places, axis=1, keepdims=True)
    _, first, joined = np.unique(np.round(places, 9), axis=0, return_index=True, return_inverse=True)
    return centre + radius * places[first], joined.ravel()[np.concatenate(triangles)].astype(np.int64)


def _division(n: int) -> tuple[FloatArray, IntArray]:
    """Barycentric coordinates of the nodes, and the triangles, of a triangle divided in n² alike."""
    index = {(i, j): k for k, (i, j) in enumerate((i, j) for i in range(n + 1) for j in range(n + 1 - i))}
    share = np.array([[n - i - j, i, j] for i, j in index], dtype=float) / n
    pieces = [[index[i, j], index[i + 1, j], index[i, j + 1]] for i in range(n) for j in range(n - i)]
    inner = ((i, j) for i in range(n - 1) for j in range(n - 1 - i))
    pieces += [[index[i + 1, j], index[i + 1, j + 1], index[i, j + 1]] for i, j in inner]
    return share, np.array(pieces)
