"""Detection between material points: those of two bodies that are nearer than spheres of their size touch.

Source: M. Xiao, C. Liu, W. C. Sun (2021), DP-MPM: Domain partitioning material point method for evolving
multi-body thermal-mechanical contacts during dynamic fracture and fragmentation, CMAME 385, 114063 (not at
hand), and A. de Vaucorbeil, V. P. Nguyen (2021), Modelling contacts with a total Lagrangian material point
method, CMAME 373, 113503: points of different bodies repel each other along the line of their centres. A
sphere's radius is half the edge of a cube of its present volume, as in Karamelo, the public code of the
second.

Assumed here: a row has the area of the smaller point's cube, and acts at the place between the two.
The published law, :mod:`mpmfw_contact.particles`, acts on the centres.
"""

from __future__ import annotations

import math

import numpy as np

from mpmfw.api import ContactRows, Detection, Grid, Particles, Setup, State, Stencil
from mpmfw.kernels import device, kernel
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.facets import Boxes, bounding_boxes, boxes_apart
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Points, Table

#: Reach over the sum of the radii up to which two points have a row, a step before they touch.
NEAR = 1.25


@device
def radius(volume: Float, dim: int) -> Float:
    """Half the edge of a cube of this volume: spheres in a lattice touch."""
    return 0.5 * (math.sqrt(volume) if dim == 2 else volume ** (1.0 / 3.0))


@device
def bucket_of(p: int, position: Floats, size: Float, moved_by: int, buckets: int) -> int:
    """Bucket of point p's cell of edge ``size``, or of a neighbour: digits of ``moved_by`` to the base 3."""
    key, rest = 0, moved_by
    for d in range(position.shape[1]):
        cell = math.floor(position[p, d] / size) + (rest % 3 - 1 if moved_by >= 0 else 0)
        key = (key * 73856093) ^ (cell * 19349663)
        rest //= 3
    return key & (buckets - 1)


@device
def may_meet(p: int, position: Floats, body: int, boxes: Boxes, reach: Float) -> bool:
    """Return True if point p lies within ``reach`` of a body's box."""
    for d in range(position.shape[1]):
        x = position[p, d]
        if x < boxes.lower[body, d] - reach or x > boxes.upper[body, d] + reach:
            return False
    return True


@kernel
def find_near(
    pairs: Ints, first: Ints, points: Points, reach: float, boxes: Boxes, head: Ints, after: Ints, rows: Rows
) -> int:
    """Write pair and identity of the points that are near each other, by ``pairs`` (pair, 2), then first and
    second point; return how many there are, stored or not.

    ``first`` (n_bodies + 1,) are the bodies' first points, ``reach`` the largest distance of near ones [m].
    ``head`` (2^k,) is the first point of a bucket, −1 before and after, ``after`` (n_p,) the next one.
    """
    count, position = 0, points.position
    for pair in range(len(pairs)):
        a, b = pairs[pair, 0], pairs[pair, 1]
        if boxes_apart(a, b, boxes.lower, boxes.upper, reach):
            continue
        for q in range(first[b], first[b + 1]):
            if may_meet(q, position, a, boxes, reach):
                k = bucket_of(q, position, reach, -1, len(head))
                after[q], head[k] = head[k], q
        for p in range(first[a], first[a + 1]):
            if may_meet(p, position, b, boxes, reach):
                count = list_neighbours(p, pair, reach, points, head, after, rows, count)
        for q in range(first[b], first[b + 1]):
            if may_meet(q, position, a, boxes, reach):
                head[bucket_of(q, position, reach, -1, len(head))] = -1
    return count


@device
def list_neighbours(
    p: int, pair: int, reach: Float, points: Points, head: Ints, after: Ints, rows: Rows, count: int
) -> int:
    """Add the points near point p from the buckets round it, in their order; return how many are listed."""
    position, volume, begin = points.position, points.volume, count
    n, dim = position.shape
    for near in range(3**dim):
        k = bucket_of(p, position, reach, near, len(head))
        seen = False  # two cells may fall in one bucket
        for before in range(near):
            seen = seen or bucket_of(p, position, reach, before, len(head)) == k
        q = -1 if seen else head[k]
        while q >= 0:
            square = 0.0
            for d in range(dim):
                square += (position[p, d] - position[q, d]) ** 2
            most = NEAR * (radius(volume[p], dim) + radius(volume[q], dim))
            if 0.0 < square < most * most:
                i, identity = count, (pair * n + p) * n + q
                if count < len(rows.pair):
                    while i > begin and rows.identity[i - 1] > identity:
                        rows.identity[i] = rows.identity[i - 1]
                        i -= 1
                    rows.pair[count], rows.identity[i] = pair, identity
                count += 1
            q = after[q]
    return count


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

    def range(self, cell_size: float) -> float:  # noqa: ARG002
        """Return that of the smallest spheres at the start: two have a row a little before they touch."""
        smallest: float = radius(float(self.state.particles.volume.min()), self.state.grid.dim)
        return (NEAR - 1.0) * 2.0 * smallest

    def prepare(self, setup: Setup, owner: str) -> None:  # noqa: ARG002
        self.state, shape = setup.state, (len(setup.bodies), setup.dim)
        count = setup.state.particles.count
        self.first = np.array([*(body.particles.start for body in setup.bodies), count], dtype=np.int64)
        self.boxes = Boxes(lower=np.zeros(shape), upper=np.zeros(shape))
        self.head = np.full(1 << max(int(count).bit_length(), 4), -1, dtype=np.int64)
        self.after = np.zeros(count, dtype=np.int64)
        self.list_pairs(setup.state)

    def list_pairs(self, state: State) -> None:
        self.pairs = np.ascontiguousarray(state.pair_bodies)

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:
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
