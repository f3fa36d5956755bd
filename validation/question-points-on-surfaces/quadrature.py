"""Detection at quadrature points of segments, and springs without rules, for comparison."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field

from mpmfw.api import AnyArray, ContactRows, FloatArray, Grid, Particles, Setup, Stencil
from mpmfw.contact.surfaces import Surfaces, SurfacesOptions
from mpmfw.contact.surfaces.assembly import Places, add_point, write_geometry
from mpmfw.contact.surfaces.detection import SurfaceRows
from mpmfw.contact.surfaces.outline import Outline
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.boxes import Boxes, bounding_boxes, square_between
from mpmfw.kernels.contact import Rows, pair_index
from mpmfw.kernels.facets import read_corners, squared_distance
from mpmfw.kernels.surfaces import signed_distance
from mpmfw.kernels.types import Float, Floats, Ints, Table
from mpmfw_contact import _springs as springs
from mpmfw_contact.penalty import PenaltyLaw


@device
def closest_of(x: Floats, b: int, radius: Float, outline: Outline, spacing: tuple[float, ...]) -> int:
    """The segment of body b that is closest to a point, −1 if none is within ``radius`` [m]."""
    corners = scratch.matrix(spacing, spacing)
    nearest, closest = radius * radius, -1
    for m in range(outline.facet_first[b], outline.facet_first[b + 1]):
        read_corners(m, outline.position, outline.facets, corners, spacing)
        square = squared_distance(x, corners, spacing)
        if square < nearest:
            nearest, closest = square, m
    return closest


@device
def motion_between(c: int, s: int, share: Float, outline: Outline, rows: Rows, places: Places) -> None:
    """B v Δt of row c, whose slave is the point ``share`` of segment s."""
    for d in range(rows.motion.shape[1]):
        start, end = outline.displacement[s, d], outline.displacement[outline.facets[s, 1], d]
        rows.motion[c, d] = (1.0 - share) * start + share * end
    for corner in range(2):
        p, along = outline.facets[places.facet[c], corner], 0.0
        for d in range(2):
            rows.motion[c, d] -= places.share[c, corner] * outline.displacement[p, d]
            along += rows.normal[c, d] * outline.displacement[p, d]
        if len(places.turn) > 0:
            for d in range(2):
                rows.motion[c, d] += places.turn[c, corner, d] * along


@kernel
def rows_of_points(
    points: Floats, parts: Floats, radius: float, length: Floats, outline: Outline, rank: Ints,
    boxes: Boxes,
    pair_of: Ints, pair_first: Ints, table: Table, place: Ints, rows: Rows, places: Places,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """A row for every point within ``radius`` of another body, against its closest segment; −1 where there is
    no room.

    ``points`` are ξ of the points of a segment, ``parts`` their share of its ``length`` (n_s,) [m] at the
    start: the area of a row is constant, so that all forces are derivatives of Σ k g² / 2, g the distance.
    """
    c, top, n_bodies, body = 0, 0, len(outline.body_first) - 1, outline.body
    x, share, normal = scratch.vector(spacing), scratch.vector(spacing), scratch.vector(spacing)
    for s in range(len(body)):
        e = outline.facets[s, 1]
        for q in range(len(points)):
            for d in range(2):
                x[d] = outline.position[s, d] + points[q] * (outline.position[e, d] - outline.position[s, d])
            for b in range(n_bodies):
                if b == body[s] or rank[body[s]] > rank[b]:
                    continue
                if square_between(x, x, boxes.lower[b], boxes.upper[b], spacing) > radius * radius:
                    continue
                m = closest_of(x, b, radius, outline, spacing)
                if m < 0:
                    continue
                if c >= len(rows.pair) or top + 64 > len(rows.dof):
                    return -1
                g = signed_distance(x, m, outline, share, normal, spacing)
                p = pair_index(pair_of, body[s], b)
                rows.pair[c], rows.identity[c], rows.gap[c] = p, (s * len(points) + q) * n_bodies + b, g
                rows.sign[c] = 1.0 if pair_first[p] == body[s] else -1.0
                rows.tributary_area[c] = parts[q] * length[s]
                rows.area[c] = rows.tributary_area[c]
                places.slave[c], places.facet[c] = s, m
                write_geometry(c, share, normal, outline, rows, places, spacing)
                motion_between(c, s, points[q], outline, rows, places)
                rows.start[c] = top
                top = add_point(s, 1.0 - points[q], c, -1, top, table, place, rows, places, spacing)
                top = add_point(e, points[q], c, -1, top, table, place, rows, places, spacing)
                for corner in range(2):
                    node = outline.facets[m, corner]
                    top = add_point(
                        node, -places.share[c, corner], c, corner, top, table, place, rows, places, spacing
                    )
                c += 1
                rows.start[c] = top
    return c


class QuadratureOptions(SurfacesOptions):
    """Those of surfaces, and the number of Gauss points on a segment."""

    points: int = Field(2, ge=1, le=6, description="Gauss points of a segment")


class Quadrature(Surfaces):
    """Gauss points of every segment against the closest segment of each other body."""

    name = "quadrature"
    Options = QuadratureOptions

    def prepare(self, setup: Setup, owner: str) -> None:
        """Points and weights, and the segments' lengths."""
        super().prepare(setup, owner)
        points, weights = np.polynomial.legendre.leggauss(self.options.points)
        self.points, self.parts = 0.5 * (points + 1.0), 0.5 * weights / (2.0 if self.two_passes else 1.0)
        ends = self.surface.position[self.surface.facets[:, 1]]
        self.length: FloatArray = np.linalg.norm(ends - self.surface.position, axis=1)

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:  # noqa: ARG002
        """Every point against every body whose box is near."""
        assert isinstance(rows, SurfaceRows)
        boxes, place = self.near.boxes, np.zeros(len(grid.mass), dtype=np.int64)
        bounding_boxes(self.outline.body_first, self.outline.position, boxes.lower, boxes.upper)
        while True:
            rows.count = rows_of_points(
                self.points, self.parts, self.radius, self.length, self.outline, self.rank, boxes,
                self.near.pair_of, self.near.first, self.surface.table, place, rows, rows.places,
                grid.spacing,
            )  # fmt: skip
            if rows.count >= 0:
                return
            rows.make_room(2 * len(rows.pair), 2 * len(rows.dof))

    def end_step(self) -> None:
        """Nothing is followed from step to step."""

    def outputs(self, rows: ContactRows) -> dict[str, AnyArray]:
        """Forces of the points, shared by the nodes of their segments as by linear functions."""
        assert isinstance(rows, SurfaceRows)
        n, places, facets = slice(rows.count), rows.places, self.outline.facets
        along = self.points[rows.identity[n] // (len(self.outline.body_first) - 1) % len(self.points)]
        shares = ((1.0 - along, along), (-places.share[n, 0], -places.share[n, 1]))
        self.force.fill(0.0)
        for segments, parts in zip((places.slave[n], places.facet[n]), shares, strict=True):
            for corner, part in enumerate(parts):
                np.add.at(self.force, facets[segments, corner], part[:, None] * rows.force[n])
        return {"force": self.force}


class PlainSprings(PenaltyLaw):
    """Penalty springs without the rules for areas that change while loaded."""

    name = "plain"

    def stiffness(self, rows: ContactRows, old: ContactRows) -> FloatArray:  # noqa: ARG002
        """k = κ M A / h."""
        own: Any = rows.own
        n = slice(rows.count)
        own.effective_area[n], own.rest[n] = rows.area[n], 0.0
        own.k[n] = self.modulus[rows.pair[n]] * rows.area[n]
        own.limit_k[n] = self.stiffest * own.k[n]
        deep = np.flatnonzero(-rows.gap[n] > self.linear_to)
        grown = 2.0 * springs.GROWTH * (-rows.gap[deep] / self.linear_to - 1.0)
        own.limit_k[deep] *= 1.0 + grown
        tangent: FloatArray = own.limit_k
        return tangent
