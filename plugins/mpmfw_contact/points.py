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

import numpy as np

from mpmfw.api import ContactRows, Detection, Grid, Particles, Setup, State, Stencil
from mpmfw_contact._near_points import (
    NEAR,
    Buckets,
    Neighbours,
    Points,
    enclose,
    find_near,
    radius,
    write_point_rows,
)


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

    def new_rows(self, own: dict[str, int | None]) -> ContactRows:
        """Rows with the entries of two points, without a couple: both sides are at one place.

        They tell no spin: where bodies turn about the normal, what friction has stored stays as it is in
        space.
        """
        return ContactRows(self.state.grid.dim, couples=False, own=own)

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
