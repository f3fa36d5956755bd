"""Rectangles of a surface that are cut in four triangles from the centre: the functions of CPDI on them.

CPDI interpolates the grid's functions between the corners of its domains, so that Σ V ∇φ over points that
tile a box is ∮ φ n dA of functions that are bilinear on the faces of the outermost domains. At a rectangle's
centre such a function is the mean of what it is at the corners, which is the grid's own where no kink lies in
between. Where a rectangle is no face of a point's domain the two sides differ anyhow, and the grid's own
functions are the better quadrature.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from mpmfw.api.types import AnyArray, FloatArray, IntArray, Particles, Stencil, Surface
from mpmfw.kernels import kernel
from mpmfw.kernels.stencil import entries
from mpmfw.kernels.types import Indices, Ints, Table
from mpmfw_shape._tables import shown

#: Distance over a rectangle's size within which a node is its centre, or its corners are those of a point's
#: face.
CENTRED = 1e-9
#: Corners of a hexahedron's face, and of a rectangle, as signs of two half-edges.
SIGNS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])


def corners_of_centres(surface: Surface) -> tuple[IntArray, IntArray]:
    """Return surface nodes (k,) in the middle of four facets, and the facets' other corners (k, 4)."""
    facets, position = surface.facets, surface.position
    last = np.bincount(facets[:, -1], minlength=len(position))
    centre = np.flatnonzero((last == 4) & (np.bincount(facets.ravel(), minlength=len(position)) == 4))
    around = facets[np.isin(facets[:, -1], centre)]
    # each corner is the first of one of the four
    corners = around[np.argsort(around[:, -1], kind="stable"), 0].reshape(-1, 4)
    away = position[corners].mean(axis=1) - position[centre]
    size = np.linalg.norm(position[corners[:, 2]] - position[corners[:, 0]], axis=1)
    kept = np.linalg.norm(away, axis=1) <= CENTRED * size
    return centre[kept], corners[kept]


def are_faces(rectangles: FloatArray, position: FloatArray, half_edges: FloatArray) -> AnyArray:
    """Return whether each rectangle (k, 4, 3) [m] is a face of a domain at the start, (k,).

    Domains have centres ``position`` (n, 3) and ``half_edges`` (n, 3, 3) [m]."""
    centre = rectangles.mean(axis=1)
    nearest = cKDTree(position).query(centre)[1]
    middle, half = position[nearest], half_edges[nearest]
    found = np.zeros(len(rectangles), dtype=bool)
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        across = half[:, np.newaxis, :, b] * SIGNS[:, :1] + half[:, np.newaxis, :, c] * SIGNS[:, 1:]
        for side in (-1.0, 1.0):
            face = (middle + side * half[:, :, a])[:, np.newaxis] + across
            distance = np.linalg.norm(rectangles[:, :, np.newaxis] - face[:, np.newaxis], axis=-1)
            found |= distance.min(axis=2).max(axis=1) <= CENTRED * np.linalg.norm(across[:, 0], axis=1)
    return found


@kernel
def mean_rows(index: Ints, corners: Ints, plain: Table, place: Indices, table: Table) -> None:
    """Copy the table ``plain`` of surface nodes to ``table``; where ``index`` (n_s,) is that of a rectangle,
    and not −1, the row is the mean of its corners' (k, 4).

    ``place`` (n_nodes,) is scratch, of any content within 0 … the table's length: the entry that a grid node
    was given last.
    """
    nodes, weight, out_nodes, out_weight = plain.nodes, plain.weight, table.nodes, table.weight
    top = 0
    table.row[0] = 0
    for s in range(len(index)):
        if index[s] < 0:
            for j in entries(plain.row, s):
                out_nodes[top], out_weight[top] = nodes[j], weight[j]
                top += 1
        else:
            start = top
            for a in range(4):
                for j in entries(plain.row, corners[index[s], a]):
                    entry = place[nodes[j]]
                    if entry < start or entry >= top or out_nodes[entry] != nodes[j]:
                        entry = place[nodes[j]] = top
                        out_nodes[top], out_weight[top] = nodes[j], 0.0
                        top += 1
                    out_weight[entry] += 0.25 * weight[j]
        table.row[s + 1] = top


class Rectangles:
    """The table of a tracked surface with such centres; ``half_edges`` (n, 3, 3) [m] are those of domains."""

    def __init__(self, surface: Surface, particles: Particles, half_edges: FloatArray) -> None:
        centre, corners = corners_of_centres(surface)
        faces = np.zeros(len(centre), dtype=bool)
        for body in range(len(surface.first) - 1):
            if particles.first[body] == particles.first[body + 1]:
                continue
            of_body = (centre >= surface.first[body]) & (centre < surface.first[body + 1])
            points = slice(particles.first[body], particles.first[body + 1])
            rectangles = surface.position[corners[of_body]]
            faces[of_body] = are_faces(rectangles, particles.position[points], half_edges[points])
        centre, self.corners = centre[faces], corners[faces]
        count = surface.on_grid
        self.index = np.full(count, -1)
        self.index[centre] = np.arange(len(centre))
        room = 2**3 * (count + 3 * len(centre))
        self.place = np.zeros(0, dtype=np.int32)
        row, nodes = np.zeros(count + 1, dtype=np.int64), np.zeros(room, dtype=np.int32)
        self.table = Stencil(row, nodes, np.zeros(room), np.zeros((0, 3)))

    def table_of(self, plain: Stencil, grid_nodes: int) -> Stencil:
        """Return the table ``plain`` of the nodes with centres as means of their corners.

        ``grid_nodes`` is the number of nodes of all velocity fields."""
        if len(self.place) < grid_nodes:
            self.place = np.zeros(grid_nodes, dtype=np.int32)
        mean_rows(self.index, self.corners, plain, self.place, self.table)
        return shown(self.table)
