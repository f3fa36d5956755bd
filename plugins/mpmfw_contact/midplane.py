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
    Setup,
    State,
    Stencil,
)
from mpmfw.contact.surfaces.near_facets import TravelLimit, VerletList
from mpmfw.contact.surfaces.outline import outline_of, tracked_surface
from mpmfw_contact._midlines import write_midlines
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
    range_option = "search_radius"
    dimensions = (2,)
    dimensions_note = "the plane form of a method for space: polygons that two facets share are not built"

    def parts(self, contact: object) -> list[TravelLimit]:  # noqa: ARG002
        """The limit of travel."""
        return [TravelLimit(self)]

    def reach(self, cell_size: float) -> float:
        """The search radius."""
        return self.options.search_radius * cell_size

    def prepare(self, setup: Setup, owner: str) -> None:
        """Arrays of the search."""
        self.state, self.has_friction = setup.state, setup.has_friction
        self.surface = tracked_surface(setup, owner)
        self.outline = outline_of(self.surface)
        self.radius = self.reach(setup.cell_size)
        self.near = VerletList(
            self.outline.facets, self.outline.facet_first, self.outline, self.radius, setup.state.grid.spacing
        )
        self.list_pairs(setup.state)

    def new_rows(self, own: dict[str, int | None]) -> ContactRows:
        """Rows with a couple on both sides where there is friction."""
        return ContactRows(self.state.grid.dim, couples=self.has_friction, own=own)

    def list_pairs(self, state: State) -> None:
        """Search the segments of each body against those of bodies with a higher index."""
        self.near.list_pairs(state.pair_bodies, np.arange(len(state.bodies)))

    def find(self, grid: Grid, phi: Stencil, particles: Particles, rows: ContactRows) -> None:  # noqa: ARG002
        """Find the segments that are near each other, and write their rows."""
        rows.count = 0
        if not self.near.update():
            return
        while True:
            rows.count = write_midlines(
                self.near.near, self.radius, self.outline, self.near.pair_of, self.near.first,
                self.surface.table, rows, grid.spacing,
            )  # fmt: skip
            if rows.count >= 0:
                return
            rows.make_room(2 * len(rows.pair), 2 * len(rows.dof))


class MidplaneContact(ForceContact):
    """Linear springs on what segments of two bodies have in common, neither of which is master."""

    name = "midplane"
    Detection = Midplane
    Law = Hamad2017Law
