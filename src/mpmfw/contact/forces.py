"""Bases of laws: forces beside the internal ones, and impulses that correct momentum."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np

from mpmfw.contact.law import ContactLaw, PairRecords
from mpmfw.contact.rows import ContactRows
from mpmfw.kernels.contact import add_records, match_rows
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.history import IndexMap, check_indices
from mpmfw.state.structs import Grid, Particles, Stencil


class ForceLaw(ContactLaw):
    """Base of laws of forces beside the internal ones (eq. 12 of [H17]), which limit the step."""

    gives_forces = True
    history: ClassVar[tuple[str, ...]] = ("old", "omega_squared", "law_step")
    #: Normal dashpot as a fraction of critical.
    damping: float = 0.0

    def estimate_frequency(self, bulk_frequency: float) -> float:
        """Return ω² of springs between equal bodies [1/s²]; ``bulk_frequency`` is 2 c / h [1/s]."""
        raise NotImplementedError

    def stiffness(self, rows: ContactRows, old: ContactRows) -> FloatArray:
        """Return the tangent stiffness of every row (n,) [N m^(dim−4)], in contact or not: it limits the
        step. ``old`` are the rows of the last step, where ``rows.previous`` points."""
        raise NotImplementedError

    def longest_step(self, rows: ContactRows, grid: Grid) -> float:  # noqa: ARG002
        """Return the step [s] that ``rows`` allow beside their stiffness."""
        return math.inf

    def forces(self, rows: ContactRows, old: ContactRows, dashpot: float, records: PairRecords) -> None:
        """Write ``rows.force``, and add to the pairs' works and energies in ``records``.

        ``rows`` and ``old`` are as in :meth:`stiffness`, which was called before. ``dashpot`` is c / (k
        Δt) [1] of a dashpot of the fraction ``damping`` of critical, Δt that of the last step [s]."""
        raise NotImplementedError

    def restored(self) -> None:
        """Raise ``NotSaved`` for rows of pairs that do not exist."""
        check_indices(len(self.state.pairs), pair=self.old.pair[: self.old.count])

    def monitors(self) -> list[Any]:
        from mpmfw.contact.events import ContactEvents

        return [ContactEvents(self)]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        super().setup(setup)
        self.bulk_frequency = setup.bulk_frequency
        #: ω² of this step's rows [1/s²]; before the first detection that of equal bodies.
        self.omega_squared = self.estimate_frequency(self.bulk_frequency)
        self.law_step = math.inf  #: that the law allows beside it [s]

    @hookimpl
    def detect(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Find the rows, and the highest frequency that they give the grid."""
        rows, old = self.rows, self.old
        self.find_rows(grid, phi, particles)
        self.omega_squared, self.law_step = 0.0, math.inf
        if rows.count:
            least_gap = match_rows(rows, rows.count, old, old.count)
            stiffness = self.stiffness(rows, old)
            self.omega_squared = rows.couplings(stiffness, grid, stiffness)
            self.law_step = self.longest_step(rows, grid)
            if not least_gap <= 0.0:
                # The step in which they touch must not be longer than the next: with the square of the depth
                # that it leaves grows the energy that nothing paid for
                self.omega_squared = max(self.omega_squared, self.estimate_frequency(self.bulk_frequency))

    @hookimpl
    def add_nodal_force(self, grid: Grid, dt: float) -> None:
        rows, old = self.rows, self.old
        if rows.count == 0 and old.count == 0:
            return
        period = math.sqrt(self.omega_squared) * self.state.dt
        # c = ζ 2 sqrt(k m) with the mass k / ω² of the highest frequency, per length of the last step
        dashpot = 2.0 * self.damping / period if period > 0.0 else 0.0
        self.forces(rows, old, dashpot, self.records)
        rows.add_to(grid.force, grid.spacing)
        add_records(rows, rows.count, dt, self.records, grid.spacing)
        self.detection.note_forces(rows, dt)

    def work_over_last_step(self) -> float:
        """Return the work [J/m] of this step's forces on the last step's motion."""
        rows, n = self.rows, slice(self.rows.count)
        return float(np.vdot(rows.force[n], rows.motion[n]))

    @hookimpl
    def advect(self, grid: Grid, dt: float) -> None:
        """Note every row's motion in the step of ``dt`` [s]; rows become history."""
        rows = self.rows
        if "moved" in rows.own.member_names and rows.count:
            rows.motion_of(grid.velocity, dt, rows.own.moved, grid.spacing)
        self.rows, self.old = self.old, rows

    def copy_history(self, other: ContactLaw, index_map: IndexMap) -> None:
        super().copy_history(other, index_map)
        self.old.copy_history(other.last_rows, index_map)

    @property
    def last_rows(self) -> ContactRows:
        return self.old

    @hookimpl
    def stable_timestep(self) -> tuple[float, str] | None:
        """Return 2 / sqrt(ω_bulk² + ω²) [s], since bulk and springs act together, or what the law allows."""
        if self.omega_squared == 0.0 and self.law_step == math.inf:
            return None
        zeta = self.damping
        # A dashpot that lags by a step takes away from the limit of its spring: 2 (√(1 + ζ²) − ζ) / ω.
        omega_squared = self.omega_squared / (math.sqrt(1.0 + zeta * zeta) - zeta) ** 2
        resolved = 2.0 / math.sqrt(self.bulk_frequency**2 + omega_squared)
        if self.law_step < resolved:
            return self.law_step, f"{self.law_name} at the present approach"
        return resolved, f"{self.law_name} springs and bulk"


class ImpulseLaw(ContactLaw):
    """Base of laws of impulses, which correct projected and updated momentum, and MUSL's second."""

    #: Whether it corrects the projected momentum with USF alone, whose strain follows from that.
    waits_for_forces: ClassVar[bool] = False
    history: ClassVar[tuple[str, ...]] = ("rows",)
    #: Length of the step [s], known whenever impulses are asked for.
    dt: float = 0.0

    def impulses(self, rows: ContactRows, grid: Grid, work: FloatArray | None, *, projected: bool) -> None:
        """Write ``rows.force``, the impulses [N s m^(dim−3)] that follow from the momentum of ``grid``; the
        caller adds them to it.

        ``work`` of friction of every pair is to be added to [J m^(dim−3)]; it is None where the correction
        moves no point. A ``projected`` momentum is that before forces have acted.
        """
        raise NotImplementedError

    @hookimpl
    def detect(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        self.find_rows(grid, phi, particles)
        rigid = self.state.rigid
        if rigid is not None and not rigid.prescribed.all():
            self.rows.response = rigid.inverse_mass
        # of forces; the rows have the impulses of each correction
        self.cohesion = self.rows.cohesion.copy()

    @hookimpl
    def after_momentum_projection(self, grid: Grid, dt: float) -> None:
        """Correct the projected momentum, without cohesion; ``dt`` is the step [s]."""
        self.dt = dt
        self.rows.cohesion[:] = 0.0
        self._correct(grid, projected=True)
        self.of_projected = self.rows.force[: self.rows.count].copy()

    @hookimpl
    def after_momentum_update(self, grid: Grid, dt: float) -> None:
        """Correct the updated momentum, at the same rows, which keep both impulses.

        ``dt`` is the step [s]."""
        self.rows.cohesion[:] = dt * self.cohesion
        self._correct(grid, projected=False)
        self.rows.force[: self.rows.count] += self.of_projected

    @hookimpl
    def after_second_projection(self, grid: Grid) -> None:
        """Correct MUSL's second momentum; it moves no point, and is in no record."""
        if self.rows.count:
            of_step = self.rows.force[: self.rows.count].copy()
            self.impulses(self.rows, grid, None, projected=False)
            self.rows.add_to(grid.momentum, grid.spacing)
            self.rows.force[: self.rows.count] = of_step

    def _correct(self, grid: Grid, *, projected: bool) -> None:
        rows, records = self.rows, self.records
        if rows.count == 0:
            records.count.fill(0.0)
            return
        if projected and self.waits_for_forces and self.scheme != "usf":
            rows.force[: rows.count] = 0.0
        else:
            self.impulses(rows, grid, records.frictional_work, projected=projected)
        rows.add_to(grid.momentum, grid.spacing)
        add_records(rows, rows.count, 1.0, records, grid.spacing)
        self.detection.note_forces(rows, 1.0)
