"""Laws of impulses, and their contact: what corrects the grid's momentum."""

from __future__ import annotations

from typing import ClassVar

from mpmfw.contact.parts import ContactLaw
from mpmfw.contact.row_contact import RowContact
from mpmfw.contact.rows import ContactRows
from mpmfw.kernels.contact import add_records
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Grid, Particles, Stencil


class ImpulseLaw(ContactLaw):
    """An impulse on every row, which corrects the grid's momentum and needs no shorter step."""

    #: Length of the step [s], known whenever impulses are asked for.
    dt: float = 0.0

    def impulses(self, rows: ContactRows, grid: Grid, work: FloatArray | None, *, projected: bool) -> None:
        """Write ``rows.force``, the impulses [N s m^(dim−3)] that the momentum of ``grid`` asks for; the
        caller adds them to it.

        ``work`` of friction of every pair is to be added to [J m^(dim−3)]; it is None where the correction
        moves no point. A ``projected`` momentum is that before forces have acted.
        """
        raise NotImplementedError


class ImpulseContact(RowContact):
    """Impulses on rows correct the grid's momentum: the projected and the updated one, and MUSL's second."""

    Law: ClassVar[type[ImpulseLaw]]  #: what acts on the rows

    @hookimpl
    def detect(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Find the rows where the bodies are now."""
        self.find_rows(grid, phi, particles)
        # of forces; the rows have the impulses of each correction
        self.cohesion = self.rows.cohesion.copy()

    @hookimpl
    def after_momentum_projection(self, grid: Grid, dt: float) -> None:
        """Correct the projected momentum; cohesion holds against the step's forces, which have not acted
        yet. ``dt`` [s] is the length of the step."""
        self.law.dt = dt
        self.rows.cohesion[:] = 0.0
        self._correct(grid, projected=True)

    @hookimpl
    def after_momentum_update(self, grid: Grid, dt: float) -> None:
        """Correct the updated momentum, at the same rows; ``dt`` [s] is the length of the step."""
        self.rows.cohesion[:] = dt * self.cohesion
        self._correct(grid, projected=False)

    @hookimpl
    def after_second_projection(self, grid: Grid) -> None:
        """Correct MUSL's second momentum, from which the strain is taken, at the same rows.

        Else bodies that no longer approach are strained as if they did. No point moves with this momentum:
        its impulse and work are in no record.
        """
        if self.rows.count:
            self.law.impulses(self.rows, grid, None, projected=False)
            self.rows.add_to(grid.momentum, grid.spacing)

    def _correct(self, grid: Grid, *, projected: bool) -> None:
        rows, records = self.rows, self.records
        if rows.count == 0:
            records.count.fill(0.0)
            return
        self.law.impulses(rows, grid, records.frictional_work, projected=projected)
        rows.add_to(grid.momentum, grid.spacing)
        add_records(rows, rows.count, 1.0, records, grid.spacing)
        self.detection.note_forces(rows, 1.0)


ImpulseLaw.Contact = ImpulseContact
