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
from pydantic import BaseModel, ConfigDict, Field

from mpmfw.api import ContactRows, Grid, Particles, Setup, Stencil
from mpmfw.api.types import IntArray, Surface
from mpmfw.contact.surfaces import OnFacets
from mpmfw.contact.surfaces.near_facets import NearFacets
from mpmfw.contact.surfaces.outline import hidden
from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.contact import Rows, pair_index
from mpmfw.kernels.types import Ints, Table
from mpmfw_contact._segment_pairs import add_side, common_part, gap_at, set_midline, shadow, share_at
from mpmfw_contact.hamad2017 import Hamad2017Law

#: Depth over the search radius beyond which two segments are taken for the far sides of their bodies.
DEEPEST = 0.5

#: Gauss points on a segment, from its middle, in half lengths: exact for the work of a linear pressure on a
#: linear gap.
GAUSS = 3.0**-0.5


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


class MidplaneDetectionOptions(BaseModel):
    """The search."""

    model_config = ConfigDict(extra="forbid", frozen=True)

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
        """Rank by index: segments of each body meet those of bodies with a higher one."""
        return np.arange(len(setup.bodies))

    def new_rows(self, own: dict[str, int | None]) -> ContactRows:
        """Return rows with a couple on both sides where there is friction."""
        return ContactRows(self.state.grid.dim, couples=self.has_friction, own=own)

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:  # noqa: ARG002
        """Find the segments that are near each other, and write their rows."""
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
