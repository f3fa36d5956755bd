"""Detection between material points: those of two bodies that are nearer than spheres of their size touch; in
2D and 3D.

Source: M. Xiao, C. Liu, W. C. Sun (2021), DP-MPM: Domain partitioning material point method for evolving
multi-body thermal-mechanical contacts during dynamic fracture and fragmentation, CMAME 385, 114063, and A. de
Vaucorbeil, V. P. Nguyen (2021), Modelling contacts with a total Lagrangian material point method, CMAME 373,
113503, where points of different bodies repel each other along the line of their centres, as in the discrete
element method. A sphere has half the edge of a cube of the point's present volume as its radius, as in
Karamelo, the public code of the second; the first paper was not at hand.

Assumed here: a row bears with the area of the smaller point's cube, and acts at the place between the two, to
which the weights of both points are taken by their gradients. The published law,
:mod:`mpmfw_contact.particles`, acts on the centres.
"""

from __future__ import annotations

import math

import numpy as np

from mpmfw.api import ContactRows, Detection, Grid, Particles, Setup, State, Stencil
from mpmfw.kernels import Struct, device, kernel
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.types import Float, Floats, Indices, Ints

#: Reach over the sum of the radii up to which two points have a row: a step before they touch knows of the
#: springs to come.
NEAR = 1.25


class Points(Struct):
    """Material points as spheres, body after body."""

    begin: Ints  #: (n_bodies,) first point of each body
    end: Ints  #: (n_bodies,) that behind its last
    position: Floats  #: (n_p, dim) [m]
    volume: Floats  #: (n_p,) [m^dim]
    lower: Floats  #: (n_bodies, dim) least coordinates of a body's points [m]
    upper: Floats  #: (n_bodies, dim) greatest
    largest: Floats  #: (n_bodies,) greatest radius [m]


class Buckets(Struct):
    """Points of a body by the bucket that their cell falls in; all empty, −1, between two pairs of bodies."""

    head: Ints  #: (2^k,) first point of a bucket, −1 where it is empty
    after: Ints  #: (n_p,) next point of the same bucket


class Neighbours(Struct):
    """Points that are near each other, by pair of bodies, then first and second point."""

    pair: Ints  #: (n,)
    first: Ints  #: (n,) point of the pair's first body
    second: Ints  #: (n,) of its second


@device
def radius(volume: Float, dim: int) -> Float:
    """Half the edge of a cube of this volume: spheres in a lattice touch."""
    return 0.5 * (math.sqrt(volume) if dim == 2 else volume ** (1.0 / 3.0))


@kernel
def enclose(points: Points, spacing: tuple[float, ...]) -> None:
    """Boxes of the bodies' points, and their greatest radii."""
    dim = len(spacing)
    for b in range(len(points.begin)):
        largest = 0.0
        for d in range(dim):
            points.lower[b, d], points.upper[b, d] = math.inf, -math.inf
        for p in range(points.begin[b], points.end[b]):
            largest = max(largest, points.volume[p])
            for d in range(dim):
                points.lower[b, d] = min(points.lower[b, d], points.position[p, d])
                points.upper[b, d] = max(points.upper[b, d], points.position[p, d])
        points.largest[b] = radius(largest, dim)


@device
def bucket_of(p: int, position: Floats, size: Float, moved_by: int, buckets: int) -> int:
    """Bucket of the cell of edge ``size`` where point p lies, or of a neighbour of it: digits of ``moved_by``
    to the base 3."""
    key, rest = 0, moved_by
    for d in range(position.shape[1]):
        cell = math.floor(position[p, d] / size) + (rest % 3 - 1 if moved_by >= 0 else 0)
        key = (key * 73856093) ^ (cell * 19349663)
        rest //= 3
    return key & (buckets - 1)


@device
def may_meet(p: int, position: Floats, lower: Floats, upper: Floats, body: int, reach: Float) -> bool:
    """Return True if point p lies within ``reach`` of a body's box."""
    for d in range(position.shape[1]):
        if position[p, d] < lower[body, d] - reach or position[p, d] > upper[body, d] + reach:
            return False
    return True


@kernel
def find_near(
    first: Ints, second: Ints, points: Points, buckets: Buckets, found: Neighbours, spacing: tuple[float, ...]
) -> int:
    """List points of the pairs of bodies ``first`` and ``second`` that are near each other; how many, stored
    or not."""
    dim, size, count = len(spacing), len(buckets.head), 0
    for pair in range(len(first)):
        a, b = first[pair], second[pair]
        reach = NEAR * (points.largest[a] + points.largest[b])
        apart = False
        for d in range(dim):
            low = max(points.lower[a, d], points.lower[b, d])
            apart = apart or low - reach > min(points.upper[a, d], points.upper[b, d])
        if apart:
            continue
        for q in range(points.begin[b], points.end[b]):
            if may_meet(q, points.position, points.lower, points.upper, a, reach):
                k = bucket_of(q, points.position, reach, -1, size)
                buckets.after[q] = buckets.head[k]
                buckets.head[k] = q
        for p in range(points.begin[a], points.end[a]):
            if may_meet(p, points.position, points.lower, points.upper, b, reach):
                count = list_neighbours(p, pair, reach, points, buckets, found, count, spacing)
        for q in range(points.begin[b], points.end[b]):
            if may_meet(q, points.position, points.lower, points.upper, a, reach):
                buckets.head[bucket_of(q, points.position, reach, -1, size)] = -1
    return count


@device
def list_neighbours(
    p: int, pair: int, reach: Float, points: Points, buckets: Buckets, found: Neighbours, count: int,
    spacing: tuple[float, ...]
) -> int:  # fmt: skip
    """Add the points near point p from the buckets round it, in their order; return how many are listed."""
    dim, begin = len(spacing), count
    for near in range(3**dim):
        k = bucket_of(p, points.position, reach, near, len(buckets.head))
        seen = False  # two cells may fall in one bucket
        for before in range(near):
            seen = seen or bucket_of(p, points.position, reach, before, len(buckets.head)) == k
        q = -1 if seen else buckets.head[k]
        while q >= 0:
            square = 0.0
            for d in range(dim):
                square += (points.position[p, d] - points.position[q, d]) ** 2
            most = NEAR * (radius(points.volume[p], dim) + radius(points.volume[q], dim))
            if 0.0 < square < most * most:
                i = count
                if count < len(found.pair):
                    while i > begin and found.second[i - 1] > q:
                        found.second[i] = found.second[i - 1]
                        i -= 1
                    found.pair[count], found.first[count], found.second[i] = pair, p, q
                count += 1
            q = buckets.after[q]
    return count


@kernel
def write_point_rows(
    listed: int, found: Neighbours, points: Points, row: Ints, nodes: Indices, weight: Floats,
    gradient: Floats,
    start_velocity: Floats, dt: float, at_centres: bool, rows: Rows, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """A row for each two points that are near each other; their number of entries, stored or not.

    The normal is the line of their centres, the gap their distance less their radii, the area that of the
    smaller one. Both sides are taken at the place x_c between them, with φ_ip + ∇φ_ip·(x_c − x_p): friction
    leaves no moment. If forces act ``at_centres`` the weights are φ_ip.
    """
    dim, n_points, m = len(spacing), len(points.volume), 0
    for c in range(listed):
        p, q = found.first[c], found.second[c]
        rows.start[c] = m
        m += row[p + 1] - row[p] + row[q + 1] - row[q]
    rows.start[listed] = m
    if m > len(rows.dof):
        return m
    for c in range(listed):
        p, q, square = found.first[c], found.second[c], 0.0
        for d in range(dim):
            rows.normal[c, d] = points.position[p, d] - points.position[q, d]
            rows.motion[c, d] = 0.0
            square += rows.normal[c, d] ** 2
        distance = math.sqrt(square)
        r_p, r_q = radius(points.volume[p], dim), radius(points.volume[q], dim)
        rows.pair[c], rows.sign[c] = found.pair[c], 1.0
        rows.identity[c] = (found.pair[c] * n_points + p) * n_points + q
        rows.gap[c] = distance - r_p - r_q
        rows.area[c] = (2.0 * min(r_p, r_q)) ** (dim - 1)
        rows.tributary_area[c] = rows.area[c]
        for d in range(dim):
            rows.normal[c, d] /= distance
        at = rows.start[c]
        for side in range(2):
            point, sign = (p, 1.0) if side == 0 else (q, -1.0)
            to_place = 0.0 if at_centres else -sign * ((r_p if side == 0 else r_q) + 0.5 * rows.gap[c])
            for k in range(row[point], row[point + 1]):
                moved = 0.0
                for d in range(dim):
                    moved += to_place * rows.normal[c, d] * gradient[k, d]
                rows.dof[at], rows.weight[at] = nodes[k], sign * (weight[k] + moved)
                for d in range(dim):
                    rows.motion[c, d] += dt * rows.weight[at] * start_velocity[nodes[k], d]
                at += 1
    return m


class PointSpheres(Detection):
    """Rows between the points of two bodies that are near each other; no surface is tracked, and none is
    smooth."""

    name = "points"
    provides = frozenset({"steady gap"})
    #: Whether forces act on the centres, and not at the place between two points.
    at_centres = False

    def reach(self, cell_size: float) -> float:
        """Two cells: no sphere that a cell has a point of is larger."""
        return 2.0 * cell_size

    def range(self, cell_size: float) -> float:  # noqa: ARG002
        """That of the smallest spheres at the start, of which two have a row a little before they touch."""
        smallest: float = radius(float(self.points.volume.min()), self.state.grid.dim)
        return (NEAR - 1.0) * 2.0 * smallest

    def prepare(self, setup: Setup, owner: str) -> None:  # noqa: ARG002
        """Spheres of the points, and the bodies of the pairs."""
        self.state, particles, bodies = setup.state, setup.state.particles, setup.bodies
        self.points = Points(
            begin=np.array([body.particles.start for body in bodies], dtype=np.int64),
            end=np.array([body.particles.stop for body in bodies], dtype=np.int64),
            position=particles.position,
            volume=particles.volume,
            lower=np.zeros((len(bodies), setup.dim)),
            upper=np.zeros((len(bodies), setup.dim)),
            largest=np.zeros(len(bodies)),
        )
        size = 1 << max(int(particles.count).bit_length(), 4)
        self.buckets = Buckets(
            head=np.full(size, -1, dtype=np.int64), after=np.zeros(particles.count, dtype=np.int64)
        )
        self.make_room(64)
        self.list_pairs(setup.state)

    def make_room(self, neighbours: int) -> None:
        """Room for so many points that are near each other."""
        names = Neighbours.member_names
        self.found = Neighbours(**{name: np.zeros(neighbours, dtype=np.int64) for name in names})

    def list_pairs(self, state: State) -> None:
        """The bodies of all pairs as arrays."""
        self.first, self.second = np.ascontiguousarray(state.pair_bodies.T)

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:
        """List the points that are near each other, and write their rows."""
        points, spacing = self.points, grid.spacing
        if points.position is not particles.position or points.volume is not particles.volume:
            points.set(position=particles.position, volume=particles.volume)
        enclose(points, spacing)
        listed = find_near(self.first, self.second, points, self.buckets, self.found, spacing)
        if listed > len(self.found.pair):
            self.make_room(2 * listed)
            find_near(self.first, self.second, points, self.buckets, self.found, spacing)
        if listed > len(rows.pair):
            rows.make_room(2 * listed, len(rows.dof))
        table = (phi.row, phi.nodes, phi.weight, phi.gradient)
        write = (listed, self.found, points, *table, grid.start_velocity, self.state.dt, self.at_centres)
        entries = write_point_rows(*write, rows, spacing)
        if entries > len(rows.dof):
            rows.make_room(len(rows.pair), 2 * entries)
            write_point_rows(*write, rows, spacing)
        rows.count = listed
