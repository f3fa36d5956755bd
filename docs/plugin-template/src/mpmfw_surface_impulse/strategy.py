"""The strategy: after the momentum update, impulses between surfaces so that none penetrates at the end of the step."""

from __future__ import annotations

import numpy as np

from mpmfw.api import (
    AnyArray,
    ContactStrategy,
    Field,
    FloatArray,
    Grid,
    SceneError,
    Setup,
    State,
    Stencil,
    hookimpl,
)
from mpmfw_surface_impulse.closest import closest_points, predict
from mpmfw_surface_impulse.contacts import Contacts
from mpmfw_surface_impulse.directions import Directions
from mpmfw_surface_impulse.neighbours import Neighbours
from mpmfw_surface_impulse.options import SurfaceImpulseOptions
from mpmfw_surface_impulse.records import SERIES, Records, record
from mpmfw_surface_impulse.rows import assemble
from mpmfw_surface_impulse.solver import solve

FORCE = Field(
    "force",
    ("surface_node", "axis"),
    "N m-1",
    "contact force on the surface node as a slave",
    "surface",
    output=True,
)

#: How much farther than the reach a search looks, in cells, so that it lasts for several steps.
SKIN = 0.25


class SurfaceImpulse(ContactStrategy):
    """Impulses λ_n ≥ 0 with g ≥ 0 and λ_n g = 0 at the end of every step, and |λ_t| ≤ μ λ_n with stick where possible.

    The gap at the end is a linear function of the impulses, through the nodal masses: a complementarity problem that
    projected Gauss-Seidel solves. There is no stiffness, and no limit of the time step beyond the bulk's, since a constraint
    takes freedoms away and cannot raise the highest frequency.
    """

    name = "surface_impulse"
    Options = SurfaceImpulseOptions
    options: SurfaceImpulseOptions
    velocity_fields = "per_body"
    needs_surface = True
    uses_friction = True
    dimensions = (2,)
    stage = "contact"

    def reach(self, cell_size: float) -> float:
        """The search radius [m]."""
        return self.options.search_radius * cell_size

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """Force of the surface nodes, and the pairs' series."""
        return [FORCE, *SERIES]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Pairs and directions of contact; nothing is searched yet."""
        if setup.state.surface is None:
            raise SceneError("contact 'surface_impulse' needs bodies with outlines")
        self.surface, self.cell_size = setup.state.surface, setup.cell_size
        self.directions = Directions.of(setup, self.options)
        self.neighbours = Neighbours(
            self.surface,
            self.directions.slave,
            self.directions.master,
            self.reach(setup.cell_size),
            SKIN * setup.cell_size,
        )
        self.records = Records(setup, self.name)
        self.force: FloatArray = setup.allocate(self.name, FORCE)
        self.predicted = np.zeros_like(self.surface.position)
        self.contacts = self._rows()
        self.last_dt = 0.0
        self.steps, self.unconverged, self.worst = 0, 0, 0.0

    def _rows(self) -> Contacts:
        """A row for each that the search found."""
        rows, directions = self.neighbours, self.directions
        return Contacts.of(
            rows.key,
            rows.node,
            directions.pair[rows.direction],
            directions.sign[rows.direction],
            directions.friction[rows.direction],
        )

    @hookimpl
    def after_momentum_update(self, grid: Grid, dt: float) -> None:
        """Search at x_s(tⁿ) and at the predicted positions, set up the rows, solve, record."""
        if self.neighbours.update():
            old, self.contacts = self.contacts, self._rows()
            self.contacts.take_impulses(old)
            if len(self.contacts) == 0:
                self._sleep()
        if len(self.contacts):
            self._collide(grid, self._table(), dt)

    def _sleep(self) -> None:
        self.force.fill(0.0)
        self.records.count.fill(0.0)

    def _table(self) -> Stencil:
        """N_i(x_s) of this step."""
        if self.surface.stencil is None:
            raise RuntimeError("the surface's table was not filled")
        return self.surface.stencil

    def _collide(self, grid: Grid, phi: Stencil, dt: float) -> None:
        self._sleep()
        if not self._find(grid, phi, dt):
            self.contacts.impulse.fill(0.0)
            return
        c = self.contacts
        self._assemble(grid, phi, dt)
        if self.last_dt > 0.0:
            c.impulse *= dt / self.last_dt
        self.last_dt = dt
        tolerance = self.options.tolerance * self.cell_size / dt
        entries = (c.start, c.grid_node, c.share, c.couple, c.normal)
        _, change = solve(
            c.segment, *entries, c.compliance_n, c.compliance_t, c.target, c.friction,
            grid.mass, grid.momentum, np.empty_like(grid.momentum),
            c.impulse, np.empty_like(c.impulse), np.empty_like(c.impulse), tolerance, self.options.sweeps,
        )  # fmt: skip
        self.steps += 1
        if change > tolerance:
            self.unconverged += 1
            self.worst = max(self.worst, change * dt / self.cell_size)
        before = grid.mass[:, None] * grid.start_velocity
        r = self.records
        record(
            c.node, c.pair, c.sign, c.segment, *entries,
            grid.mass, before, grid.momentum, c.impulse, dt,
            r.impulse, r.frictional_work, r.impact_work, r.count, self.force,
        )  # fmt: skip

    def _find(self, grid: Grid, phi: Stencil, dt: float) -> int:
        """Closest points at the start of the step, and at its end if there were no contact."""
        c, s, n = self.contacts, self.surface, self.neighbours
        reach = self.neighbours.reach
        found = closest_points(
            n.node, n.first, n.segment, reach, s.position, s.next, s.previous,
            c.segment, c.coordinate, c.gap, c.normal,
        )  # fmt: skip
        if found:
            predict(phi.row, phi.nodes, phi.weight, grid.mass, grid.momentum, s.position, dt, self.predicted)
            closest_points(
                n.node, n.first, n.segment, reach, self.predicted, s.next, s.previous,
                c.end_segment, c.end_coordinate, c.end_gap, c.end_normal,
            )  # fmt: skip
        return found

    def _assemble(self, grid: Grid, phi: Stencil, dt: float) -> None:
        c, s = self.contacts, self.surface
        c.make_room(3 * int(np.diff(phi.row).max()) * len(c))
        assemble(
            c.node, c.segment, c.coordinate, c.gap, c.normal, c.end_segment, c.end_gap, c.end_normal,
            s.position, self.predicted, s.next, s.previous,
            phi.row, phi.nodes, phi.weight, grid.mass, self.options.restore, dt,
            c.start, c.grid_node, c.share, c.couple, c.compliance_n, c.compliance_t, c.target,
        )  # fmt: skip

    def restart(self) -> None:
        """Forget impulse and work of the settling; the last impulses stay as a first guess."""
        self.records.restart()

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, AnyArray]:  # noqa: ARG002
        """The pairs' series and the surface nodes' forces."""
        return {"force": self.force, **self.records.series(interval)}

    @hookimpl
    def concerns(self) -> list[str]:
        """Steps whose impulses were not solved to the tolerance."""
        if self.unconverged == 0:
            return []
        return [
            f"surface_impulse: in {self.unconverged} of {self.steps} steps with contact {self.options.sweeps} sweeps did not "
            f"reach the tolerance of {self.options.tolerance:g} cells (at worst {self.worst:.2g}); "
            "try a larger contact.surface_impulse.sweeps"
        ]


__all__ = ["SurfaceImpulse"]
