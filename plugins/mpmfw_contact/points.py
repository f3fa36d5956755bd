"""Detection between material points: those of two bodies that are nearer than spheres of their size touch.

Source: M. Xiao, C. Liu, W. C. Sun (2021), DP-MPM: Domain partitioning material point method for evolving
multi-body thermal-mechanical contacts during dynamic fracture and fragmentation, CMAME 385, 114063 (not at
hand), and A. de Vaucorbeil, V. P. Nguyen (2021), Modelling contacts with a total Lagrangian material point
method, CMAME 373, 113503: points of different bodies repel each other along the line of their centres. A
sphere's radius is half the edge of a cube of its present volume, as in Karamelo, the public code of the
second.

Assumed here: a row bears with the area of the smaller point's cube, and acts at the place between the two.
The published law, :mod:`mpmfw_contact.particles`, acts on the centres.
"""

from __future__ import annotations

import math

import numpy as np

from mpmfw.api import ContactRows, Detection, Grid, Particles, Setup, State, Stencil
from mpmfw.kernels import kernel
from mpmfw.kernels.boxes import Boxes, bounding_boxes
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.types import Nodes, Points, Table
from mpmfw_contact._point_pairs import NEAR, find_near, radius


@kernel
def write_point_rows(
    count: int, points: Points, table: Table, grid: Nodes, dt: float, at_centres: bool, rows: Rows,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """A row for each two points that are near each other; their number of entries, stored or not.

    The normal is the line of their centres, the gap their distance less their radii. Both sides are taken at
    the place x_c between them, with φ_ip + ∇φ_ip·(x_c − x_p), or with φ_ip if forces act ``at_centres``.
    """
    dim, n, m, row = len(spacing), len(points.volume), 0, table.row
    for c in range(count):
        q, p = rows.identity[c] % n, rows.identity[c] // n % n
        rows.start[c] = m
        m += row[p + 1] - row[p] + row[q + 1] - row[q]
    rows.start[count] = m
    if m > len(rows.dof):
        return m
    for c in range(count):
        q, p, square = rows.identity[c] % n, rows.identity[c] // n % n, 0.0
        for d in range(dim):
            rows.normal[c, d] = points.position[p, d] - points.position[q, d]
            rows.motion[c, d] = 0.0
            square += rows.normal[c, d] ** 2
        distance = math.sqrt(square)
        r_p, r_q = radius(points.volume[p], dim), radius(points.volume[q], dim)
        rows.sign[c], rows.gap[c] = 1.0, distance - r_p - r_q
        rows.area[c] = rows.tributary_area[c] = (2.0 * min(r_p, r_q)) ** (dim - 1)
        for d in range(dim):
            rows.normal[c, d] /= distance
        at = rows.start[c]
        for side in range(2):
            point, sign, r = (p, 1.0, r_p) if side == 0 else (q, -1.0, r_q)
            to_place = 0.0 if at_centres else -sign * (r + 0.5 * rows.gap[c])
            for k in range(row[point], row[point + 1]):
                i, moved = table.nodes[k], 0.0
                for d in range(dim):
                    moved += to_place * rows.normal[c, d] * table.gradient[k, d]
                rows.dof[at], rows.weight[at] = i, sign * (table.weight[k] + moved)
                for d in range(dim):
                    rows.motion[c, d] += dt * rows.weight[at] * grid.start_velocity[i, d]
                at += 1
    return m


class PointSpheres(Detection):
    """Rows between the points of two bodies that are near each other; no surface is tracked."""

    name = "points"
    provides = frozenset({"steady gap"})
    finds_rigid = False
    #: Whether forces act on the centres, and not at the place between two points.
    at_centres = False

    def reach(self, cell_size: float) -> float:
        """Return two cells: no sphere that a cell has a point of is larger."""
        return 2.0 * cell_size

    def range(self, cell_size: float) -> float:  # noqa: ARG002
        """Return that of the smallest spheres at the start: two have a row a little before they touch."""
        smallest: float = radius(float(self.state.particles.volume.min()), self.state.grid.dim)
        return (NEAR - 1.0) * 2.0 * smallest

    def prepare(self, setup: Setup, owner: str) -> None:  # noqa: ARG002
        """Allocate the boxes and buckets of the search."""
        self.state, shape = setup.state, (len(setup.bodies), setup.dim)
        count = setup.state.particles.count
        self.first = np.array([*(body.particles.start for body in setup.bodies), count], dtype=np.int64)
        self.boxes = Boxes(lower=np.zeros(shape), upper=np.zeros(shape))
        self.head = np.full(1 << max(int(count).bit_length(), 4), -1, dtype=np.int64)
        self.after = np.zeros(count, dtype=np.int64)
        self.list_pairs(setup.state)

    def list_pairs(self, state: State) -> None:
        """List the bodies of all pairs."""
        self.pairs = np.ascontiguousarray(state.pair_bodies)

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:
        """List the points that are near each other, and write their rows."""
        bounding_boxes(self.first, particles.position, self.boxes.lower, self.boxes.upper)
        reach = NEAR * 2.0 * radius(float(particles.volume.max()), grid.dim)
        search = (self.pairs, self.first, particles, reach, self.boxes, self.head, self.after)
        rows.count = find_near(*search, rows)
        if rows.count > len(rows.pair):
            rows.make_room(2 * rows.count, len(rows.dof))
            find_near(*search, rows)
        write = (rows.count, particles, phi, grid, self.state.dt, self.at_centres, rows, grid.spacing)
        entries = write_point_rows(*write)
        if entries > len(rows.dof):
            rows.make_room(len(rows.pair), 2 * entries)
            find_near(*search, rows)
            write_point_rows(*write)
