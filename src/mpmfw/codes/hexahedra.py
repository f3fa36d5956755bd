"""Hexahedra: meshes of bodies for codes of finite elements; in the plane a slab of one element."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from mpmfw.codes.code import points_of_body
from mpmfw.scene import Scene
from mpmfw.state.fields import FloatArray, IntArray

#: Size of the core of a ball's elements over the ball's.
CORE = 0.5

# A hexahedron's corners, its faces S1 to S6, the other ends of its edges, and six tetrahedra in it
_CORNERS = np.array([(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
_FACES = [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]
_ENDS = [[1, 0, 3, 2, 5, 4, 7, 6], [3, 2, 1, 0, 7, 6, 5, 4], [4, 5, 6, 7, 0, 1, 2, 3]]
_TETRAHEDRA = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]


@dataclass(frozen=True)
class HexMesh:
    """Hexahedra of one body; in the plane its first half of nodes is the slab's front."""

    nodes: FloatArray  #: (n, 3) [m]
    cells: IntArray  #: (m, 8)
    outer: IntArray  #: element, and face of 1 to 6, of the outermost surface (k, 2)
    volume: FloatArray  #: lumped (n,) [m³]

    @property
    def shortest(self) -> float:
        """Shortest edge [m]."""
        x = self.nodes[self.cells]
        return min(float(np.linalg.norm(x - x[:, turn], axis=2).min()) for turn in _ENDS)


def mesh_of_body(scene: Scene, name: str, size: float, depth: float) -> HexMesh:
    """Return a body's mesh with edges up to ``size`` [m]; in the plane a slab of ``depth`` [m].

    Of two discs or rings the first meets the other with a node, and that with the middle of an edge."""
    flat = _hexahedra(scene, name, size, depth).reshape(-1, 3)
    keys = np.round(flat[:, ::-1] / np.ptp(flat, axis=0).max(), 9)  # the front's nodes are the first
    _, index, joined = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    nodes, cells = flat[index], joined.reshape(-1, 8)
    faces = cells[:, _FACES]
    same = np.unique(np.sort(faces, axis=2).reshape(-1, 4), axis=0, return_inverse=True, return_counts=True)
    element, side = np.nonzero(same[2][same[1].reshape(-1)].reshape(-1, 6) == 1)
    element, side = element[keep := side >= 2 * (scene.dim == 2)], side[keep]  # no front and back
    free = faces[element, side]
    pairs = np.repeat(free[:, :1], 4, axis=1).ravel(), free.ravel()
    part = connected_components(coo_array((np.ones(free.size), pairs), 2 * (len(nodes),)))[1]
    outside = part[free[:, 0]] == part[nodes[:, 0].argmax()]
    edges = nodes[cells[:, _TETRAHEDRA]]
    each = np.linalg.det(edges[:, :, 1:] - edges[:, :, :1]).sum(axis=1) / 6.0
    volume = np.bincount(cells.ravel(), np.repeat(each / 8.0, 8)).astype(float)
    return HexMesh(nodes, cells, np.column_stack([element, side + 1])[outside], volume)


def _hexahedra(scene: Scene, name: str, size: float, depth: float) -> FloatArray:
    """Return the corners (m, 8, 3) [m] of a body's elements."""
    body: Any = scene.bodies[name]
    shape = body.geometry
    if shape.type == "ball":
        return np.asarray(shape.centre + shape.radius * _ball(size / shape.radius))
    layout = points_of_body(scene, name, size)
    if layout.corners is None:
        half = np.einsum("pda,ka->pkd", layout.half_edges, _CORNERS)
        return np.asarray(layout.position[:, None] + half)
    corners = layout.corners
    discs = [one.geometry for one in scene.bodies.values() if one.geometry.type in ("disc", "ring")]
    if len(discs) == 2 and shape in discs:
        centre, is_first = shape.centroid, shape is discs[0]
        place = (corners - centre).reshape(-1, 2)
        far = place[np.hypot(*place.T) > np.hypot(*place.T).max() * (1 - 1e-6)]
        rim = np.unique(np.round(np.arctan2(far[:, 1], far[:, 0]), 9))
        towards = np.subtract(discs[int(is_first)].centroid, centre)
        middle = rim[0] if is_first else 0.5 * (rim[0] + rim[1])
        angle = math.atan2(towards[1], towards[0]) - middle
        turn = [[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]]
        corners = centre + (corners - centre) @ np.array(turn)
    layers = [np.concatenate([corners, np.full((*corners.shape[:2], 1), z)], axis=2) for z in (0.0, depth)]
    return np.concatenate(layers, axis=1)


def _ball(size: float) -> FloatArray:
    """Return the corners (m, 8, 3) of a ball of radius 1: a core between cube and ball, and six shells."""
    count = math.ceil(0.5 * math.pi / size - 1e-9)
    side = np.linspace(-1.0, 1.0, count + 1)
    grid = np.stack(np.meshgrid(side, side, side, indexing="ij"), axis=-1)
    norm = np.linalg.norm(grid, axis=-1, keepdims=True)
    ball = grid * np.abs(grid).max(axis=-1, keepdims=True) / np.where(norm > 0.0, norm, 1.0)
    core = 0.5 * CORE * (grid + ball)
    rim = np.tan(0.25 * math.pi * grid[-1])
    rim /= np.linalg.norm(rim, axis=-1, keepdims=True)
    share = np.linspace(0.0, 1.0, math.ceil((1.0 - CORE) / size - 1e-9) + 1)[:, None, None, None]
    shell = (1.0 - share) * core[-1] + share * rim
    blocks = [core, *(sign * np.roll(shell, axis, axis=-1) for sign in (1, -1) for axis in range(3))]
    cells = np.concatenate([_cells(block) for block in blocks])
    inverted = np.linalg.det(cells[:, [1, 3, 4]] - cells[:, :1]) < 0.0
    cells[inverted] = cells[inverted][:, [4, 5, 6, 7, 0, 1, 2, 3]]
    return cells


def _cells(grid: FloatArray) -> FloatArray:
    """Return the corners (m, 8, 3) of the cells between the nodes of a grid (a, b, c, 3)."""
    ends = [tuple(slice(1, None) if up > 0 else slice(-1) for up in corner) for corner in _CORNERS]
    return np.stack([grid[end].reshape(-1, 3) for end in ends], axis=1)
