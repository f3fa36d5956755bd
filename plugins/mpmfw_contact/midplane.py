"""Segments against segments on the line between them, without a master: the plane form of a 3D method.

Source: I. Sahu, N. Petrinic (2025), Midplane based 3D single pass unbiased segment-to-segment contact
interaction using penalty method, CMAME 447, 118335, arXiv 2506.04841, of which the abstract alone was at
hand: tractions between two segments are evaluated with respect to a midplane; they penalise the true
interpenetration, and are integrated over the common part. The integral in space is not built here.

Assumed here, for segments of the plane: the midline's normal is the difference of the segments' outward
normals, along which both are projected; the gap is their distance along it, and the overlap bears; two
Gauss points are exact. Tangential forces act on the midline, half of the gap from either segment. Friction
begins anew where segments slide past each other. Springs are linear, with the areas of the overlap, so that
they have an energy.
"""

from __future__ import annotations

import numpy as np
from pydantic import Field

from mpmfw.api import ContactRows, Grid, OptionsModel, Particles, Setup, Stencil
from mpmfw.api.types import IntArray, Surface
from mpmfw.contact.surfaces import OnFacets
from mpmfw.contact.surfaces.assembly import has_weights
from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.contact.surfaces.outline import hidden, opposition
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.contact import Rows, pair_index
from mpmfw.kernels.facets import length_of, read_corners, write_gradients
from mpmfw.kernels.surfaces import area_of
from mpmfw.kernels.types import Float, Floats, Ints, Table
from mpmfw_contact.hamad2017 import Hamad2017Law

#: Depth over the search radius beyond which two segments are taken for the far sides of their bodies.
DEEPEST = 0.5

#: Gauss points on a segment, from its middle, in half lengths: exact for the work of a linear pressure on a
#: linear gap.
GAUSS = 3.0**-0.5

#: Least cosine between one segment's normal and the other's reversed one. It is more than that of nodes,
#: 0.02, with which the sides of a block that lean a little push along the face that it lies on.
LEAST_COSINE = 0.1

#: Part of a segment's length by which two must overlap along it; less is rounding.
LEAST_OVERLAP = 1e-9


@device
def set_midline(m: int, other: int, outline: Surface, normal: Floats, spacing: tuple[float, ...]) -> bool:
    """Write the unit normal of the line between two segments, out of the second; False if none faces."""
    a, b = scratch.vector(spacing), scratch.vector(spacing)
    area_of(m, outline, a, spacing)
    if not opposition(a, other, outline, spacing) > LEAST_COSINE:  # a segment without length has none
        return False
    area_of(other, outline, b, spacing)
    size, other_size = length_of(a, spacing), length_of(b, spacing)
    for d in range(len(spacing)):
        normal[d] = b[d] / other_size - a[d] / size
    whole = length_of(normal, spacing)
    for d in range(len(spacing)):
        normal[d] /= whole
    return True


@device
def shadow(m: int, normal: Floats, outline: Surface, out: Floats) -> None:
    """Write places of a segment's ends along the midline and above it, s_1, s_2, z_1, z_2, to ``out`` [m]."""
    for a in range(2):
        p = outline.facets[m, a]
        out[a] = -normal[1] * outline.position[p, 0] + normal[0] * outline.position[p, 1]
        out[2 + a] = normal[0] * outline.position[p, 0] + normal[1] * outline.position[p, 1]


@device
def share_at(s: Float, ends: Floats) -> Float:
    """Coordinate ξ of the place of a segment over ``s``."""
    return (s - ends[0]) / (ends[1] - ends[0])


@device
def gap_at(s: Float, ends: Floats, other_ends: Floats) -> Float:
    """Height of the first segment over the second at ``s`` [m]."""
    xi, eta = share_at(s, ends), share_at(s, other_ends)
    return (1.0 - xi) * ends[2] + xi * ends[3] - (1.0 - eta) * other_ends[2] - eta * other_ends[3]


@device
def common_part(ends: Floats, other_ends: Floats) -> tuple[Float, Float]:
    """Return the ends of the part where two segments overlap, in which the gap is linear. Without such a part
    the first end is larger."""
    low = max(min(ends[0], ends[1]), min(other_ends[0], other_ends[1]))
    high = min(max(ends[0], ends[1]), max(other_ends[0], other_ends[1]))
    least = min(abs(ends[1] - ends[0]), abs(other_ends[1] - other_ends[0]))
    if high - low <= LEAST_OVERLAP * least:
        return 1.0, 0.0
    left, right = gap_at(low, ends, other_ends), gap_at(high, ends, other_ends)
    if left * right < 0.0:
        zero = low + (high - low) * left / (left - right)
        low, high = (low, zero) if left < 0.0 else (zero, high)
    return low, high


@device
def add_side(
    c: int, m: int, sign: Float, xi: Float, half_gap: Float, outline: Surface, table: Table, rows: Rows,
    top: int, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Entries and motion of the place ξ of segment m in row c, times ``sign``; the new top. The couple of a
    force along the midline is ½ g ∇ξ on both sides."""
    dim, has_couple = len(spacing), len(rows.couple) > 0
    corners, gradient = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    normal = scratch.vector(spacing)
    read_corners(m, outline.position, outline.facets, corners, spacing)
    for d in range(dim):
        normal[d] = -sign * rows.normal[c, d]  # out of this side
    write_gradients(corners, normal, half_gap, gradient, spacing)
    for a in range(dim):
        p, share, along = outline.facets[m, a], sign * (1.0 - xi if a == 0 else xi), 0.0
        for d in range(dim):
            rows.motion[c, d] += share * outline.displacement[p, d]
            along += rows.normal[c, d] * outline.displacement[p, d]
        for d in range(dim):
            rows.motion[c, d] += gradient[a, d] * along if has_couple else 0.0
        for k in range(table.row[p], table.row[p + 1]):
            if table.weight[k] == 0.0:
                continue
            rows.dof[top], rows.weight[top] = table.nodes[k], share * table.weight[k]
            if has_couple:
                for d in range(dim):
                    rows.couple[top, d] = table.weight[k] * gradient[a, d]
            top += 1
    return top


@kernel
def write_midlines(
    near: NearFacets, reach: float, outline: Surface, pair_of: Ints, pair_first: Ints, table: Table,
    rows: Rows, spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """Two rows for each two segments that face each other, at the Gauss points of their common part; their
    number, or −1 without room."""
    c, top, n_facets, widest = 0, 0, len(outline.facets), 0
    for p in range(len(table.row) - 1):
        widest = max(widest, table.row[p + 1] - table.row[p])
    normal = scratch.vector(spacing)
    ends, other_ends = scratch.vector((0.0, 0.0, 0.0, 0.0)), scratch.vector((0.0, 0.0, 0.0, 0.0))
    rows.start[0] = 0
    for m in range(n_facets):
        body = outline.body[outline.facets[m, 0]]
        for i in range(near.first[m], near.first[m + 1]):
            other = near.facet[i]
            theirs = outline.body[outline.facets[other, 0]]
            if hidden(m, theirs, outline) or hidden(other, body, outline):
                continue
            if not set_midline(m, other, outline, normal, spacing):
                continue
            shadow(m, normal, outline, ends)
            shadow(other, normal, outline, other_ends)
            low, high = common_part(ends, other_ends)
            middle = gap_at(0.5 * (low + high), ends, other_ends)
            if low > high or middle > reach or middle < -DEEPEST * reach:
                continue
            if not has_weights(outline.facets[m, 0], other, outline.facets, table):
                continue
            if not has_weights(outline.facets[other, 0], m, outline.facets, table):
                continue
            if c + 2 > len(rows.pair) or top + 8 * widest > len(rows.dof):
                return -1
            p = pair_index(pair_of, body, theirs)
            for point in range(2):
                s = 0.5 * (low + high) + (point - 0.5) * GAUSS * (high - low)
                rows.pair[c], rows.sign[c] = p, 1.0 if pair_first[p] == body else -1.0
                rows.identity[c] = (m * n_facets + other) * 2 + point
                rows.gap[c] = gap_at(s, ends, other_ends)
                rows.area[c] = rows.tributary_area[c] = 0.5 * (high - low)
                for d in range(len(spacing)):
                    rows.normal[c, d], rows.motion[c, d] = normal[d], 0.0
                half = 0.5 * rows.gap[c]
                top = add_side(c, m, 1.0, share_at(s, ends), half, outline, table, rows, top, spacing)
                top = add_side(
                    c, other, -1.0, share_at(s, other_ends), half, outline, table, rows, top, spacing
                )
                c += 1
                rows.start[c] = top
    return c


class MidplaneDetectionOptions(OptionsModel):
    search_radius: float = Field(
        1.0,
        gt=0,
        le=1.0,
        description="largest distance of segments that meet, and twice the largest depth, in cells",
    )


class Midplane(OnFacets):
    """Two rows for each two segments of different bodies that face each other and lie over each other."""

    name = "midplane"
    Options = MidplaneDetectionOptions
    options: MidplaneDetectionOptions
    provides = frozenset({"facets", "steady gap"})
    dimensions = (2,)
    dimensions_note = "the plane form of a method for space: polygons that two facets share are not built"

    of_facets = True

    def rank_bodies(self, setup: Setup, owner: str) -> IntArray:  # noqa: ARG002
        """Rank by index: segments of each body are tested against bodies with a higher one."""
        return np.arange(len(setup.bodies))

    def new_rows(self, own: dict[str, int | None]) -> ContactRows:
        """Return rows with a couple on both sides where there is friction."""
        return ContactRows(self.state.grid.dim, couples=self.has_friction, own=own)

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:  # noqa: ARG002
        rows.count = 0
        if not self.near.update():
            return
        self.fill(
            rows,
            lambda: write_midlines(
                self.near.near, self.radius, self.surface, self.near.pair_of, self.near.first,
                self.surface.table, rows, grid.spacing,
            ),
        )  # fmt: skip


class MidplaneContact(Hamad2017Law):
    """Linear springs on the common part of two bodies' segments, neither of which is master."""

    name = "midplane"
    Detection = Midplane
