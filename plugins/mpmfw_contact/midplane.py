"""Segments against segments on the line between them: one pass, and neither body is master; the plane form of
a 3D method.

Source: I. Sahu, N. Petrinic (2025), Midplane based 3D single pass unbiased segment-to-segment contact
interaction using penalty method, CMAME 447, 118335, arXiv 2506.04841, of which the abstract alone was at
hand: tractions between two segments are evaluated with respect to a midplane, in a single pass, so that they
are in equilibrium by themselves; they penalise the true interpenetration, and are integrated over the common
part of two segments. The published method is for facets of finite elements in space. Its integral over the
polygon that two facets share on the midplane is not built here.

Assumed here, for segments of the plane: the midline's normal is the difference of the segments' outward
normals; both are projected onto it along that; the gap is their distance along it, linear over their common
part, of which what overlaps bears; two Gauss points on that are exact. Tangential forces act on the midline,
half of the gap from either segment. Segments face each other where their normals are less than 84° from
opposite. A place is two segments' Gauss point: friction begins anew where segments slide past each other.
Springs are linear, and their areas are those of the overlap, so that they have an energy.
"""

from __future__ import annotations

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from mpmfw.api import (
    ContactRows,
    Detection,
    ForceContact,
    Grid,
    Particles,
    SceneError,
    Setup,
    State,
    Stencil,
)
from mpmfw.contact.surfaces import cells
from mpmfw.contact.surfaces.assembly import SurfaceTable
from mpmfw.contact.surfaces.candidates import no_lists
from mpmfw.contact.surfaces.covering import Seams
from mpmfw.contact.surfaces.outline import outline_of
from mpmfw.contact.surfaces.travel import TravelLimit
from mpmfw.kernels.pair_table import pair_table
from mpmfw_contact._midlines import SegmentPairs, list_segments, write_midlines
from mpmfw_contact.hamad2017 import Hamad2017Law


class MidplaneDetectionOptions(BaseModel):
    """The search."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    search_radius: float = Field(
        1.0,
        gt=0,
        le=1.0,
        description="largest distance of segments that meet, and twice the largest depth, in cells",
    )


class Midplane(Detection):
    """Two rows for each two segments of different bodies that face each other and lie over each other."""

    name = "midplane"
    Options = MidplaneDetectionOptions
    options: MidplaneDetectionOptions
    provides = frozenset({"facets", "steady gap"})
    needs_surface = True
    range_option = "search_radius"
    dimensions = (2,)
    dimensions_note = "the plane form of a method for space: polygons that two facets share are not built"

    def parts(self, contact: object) -> list[TravelLimit]:  # noqa: ARG002
        """The limit of travel."""
        return [TravelLimit(self.options.search_radius)]

    def reach(self, cell_size: float) -> float:
        """The search radius."""
        return self.options.search_radius * cell_size

    def prepare(self, setup: Setup, owner: str) -> None:
        """Arrays of the search."""
        if setup.state.surface is None:
            raise SceneError(f"contact '{owner}' needs bodies with outlines")
        self.state, self.surface, self.has_friction = setup.state, setup.state.surface, setup.has_friction
        self.outline = outline_of(self.surface)
        self.lists, self.stamp = no_lists(setup, owner), 0
        self.radius = self.reach(setup.cell_size)
        self.seams = Seams(self.outline, self.radius, setup.state.grid.spacing)
        self.table: SurfaceTable | None = None
        self.make_room(64)
        self.list_pairs(setup.state)

    def make_room(self, pairs: int) -> None:
        """Room for so many pairs of segments."""
        names = SegmentPairs.member_names
        self.found = SegmentPairs(**{name: np.zeros(pairs, dtype=np.int64) for name in names})

    def new_rows(self, own: dict[str, int | None]) -> ContactRows:
        """Rows with a couple on both sides where there is friction."""
        return ContactRows(self.state.grid.dim, couples=self.has_friction, own=own)

    def list_pairs(self, state: State) -> None:
        """The bodies of all pairs as arrays."""
        self.first = np.array([pair.first for pair in state.pairs], dtype=np.int64)
        self.second = np.array([pair.second for pair in state.pairs], dtype=np.int64)
        self.pair_of = pair_table(self.first, self.second)

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:  # noqa: ARG002
        """List the segments that are near each other, and write their rows."""
        listed, rows.count = self._search(grid), 0
        if listed == 0:
            return
        table = self.surface.stencil
        if table is None:
            raise RuntimeError("the surface's table was not filled")
        if self.table is None or self.table.weight is not table.weight:
            self.table = SurfaceTable(row=table.row, nodes=table.nodes, weight=table.weight)
        while True:
            rows.count = write_midlines(
                listed, self.found, self.radius, self.outline, self.pair_of, self.first, self.table, rows,
                grid.spacing,
            )  # fmt: skip
            if rows.count >= 0:
                return
            rows.make_room(2 * len(rows.pair), 2 * len(rows.dof))

    def _search(self, grid: Grid) -> int:
        """Number of segments of two bodies that are near each other."""
        outline, lists, spacing = self.outline, self.lists, grid.spacing
        if not cells.near_boxes(self.first, self.second, self.radius, 0.0, outline, lists):
            return 0
        self.seams.find(self.first, self.second, lists)
        self.stamp += 1
        while (entries := cells.list_facets(self.stamp, 0.0, outline, lists, spacing)) > len(lists.link):
            room = ("link", "link_facet", "link_body")
            lists.set(**{name: np.zeros(2 * entries, dtype=np.int32) for name in room})
            self.stamp += 1
        if entries == 0:
            return 0
        listed: int = list_segments(self.stamp, self.radius, outline, lists, self.found, spacing)
        if listed > len(self.found.first):
            self.make_room(2 * listed)
            listed = list_segments(self.stamp, self.radius, outline, lists, self.found, spacing)
        return listed


class MidplaneContact(ForceContact):
    """Linear springs on what segments of two bodies have in common, neither of which is master."""

    name = "midplane"
    Detection = Midplane
    Law = Hamad2017Law
