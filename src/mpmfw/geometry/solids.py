"""Ball and box."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np

from mpmfw.geometry.base import Cornered, Point3D, Round
from mpmfw.geometry.clipped_lattice import tiling
from mpmfw.geometry.layout import FloatArray, IntArray, Layout
from mpmfw.geometry.plane import number_of_segments
from mpmfw.geometry.solid import SolidGeometry, Surfaces, TurnedSolid, turning


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
