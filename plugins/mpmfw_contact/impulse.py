"""Impulses at single rows: approach is stopped, and slip within Coulomb's cone (Bardenhagen et al. 2001)."""

from __future__ import annotations

import numpy as np

from mpmfw.api import ContactRows, FloatArray, Grid, ImpulseLaw
from mpmfw.kernels import Struct, kernel, scratch
from mpmfw.kernels.contact import Rows, rigid_couplings, slip_limit
from mpmfw.kernels.types import Floats


class ImpulseArrays(Struct):
    """The law's own arrays of n rows."""

    active: Floats  #: (n,) 1 where the row takes part, else 0
    compliance: Floats  #: (n,) inverse of its mass [1/kg]
    across: Floats  #: (n,) the same of slip, where free rigid bodies have another
    velocity: Floats  #: (n, dim) B v [m/s]


@kernel
def find_approach(rows: Rows, count: int, own: ImpulseArrays, spacing: tuple[float, ...]) -> None:
    """1 for rows that touch and whose sides approach, else 0: all decided before anything moves."""
    for c in range(count):
        approach = 0.0
        for d in range(len(spacing)):
            approach -= own.velocity[c, d] * rows.normal[c, d]
        own.active[c] = 1.0 if rows.gap[c] <= 0.0 and approach > 0.0 else 0.0


@kernel
def stop(
    rows: Rows, count: int, own: ImpulseArrays, limit: Floats, projected: bool, work: Floats, repels: bool,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """J_n = m approach, J_t = min(μ |J_n| + a, m |Δv_t|), with m the inverse of the row's compliance.

    The size of J_n is at most the row's ``limit`` [N s/m], without rows where there is none. Where sides
    separate J_n holds them back, or pushes them if contact ``repels``. The ``work`` of J_t, if it has pairs,
    is on the slip: the mean of before and after of a ``projected`` momentum, else the slip of the step's end.
    """
    dim = len(spacing)
    slip = scratch.vector(spacing)
    for c in range(count):
        for d in range(dim):
            rows.force[c, d] = 0.0
        compliance = own.compliance[c]
        if own.active[c] == 0.0 or compliance == 0.0:
            continue
        approach, square = 0.0, 0.0
        for d in range(dim):
            approach -= own.velocity[c, d] * rows.normal[c, d]
        for d in range(dim):
            slip[d] = own.velocity[c, d] + approach * rows.normal[c, d]
            square += slip[d] * slip[d]
        p, speed, normal_impulse = rows.pair[c], square**0.5, approach / compliance
        if repels:
            normal_impulse = abs(normal_impulse)
        if len(limit) > 0:
            normal_impulse = max(-limit[c], min(normal_impulse, limit[c]))
        tangential = min(slip_limit(rows, c, abs(normal_impulse)), speed / own.across[c])
        for d in range(dim):
            direction = slip[d] / speed if speed > 0.0 else 0.0
            rows.force[c, d] = normal_impulse * rows.normal[c, d] - tangential * direction
        left = speed - tangential * own.across[c]
        if len(work) > 0:
            work[p] += tangential * (0.5 * (speed + left) if projected else left)


class Impulse(ImpulseLaw):
    """Every row by itself; the mass of nodes that several rows share is divided between those that approach.

    The mass of row c is 1 / Σ_i |b_ci| (Σ_d |b_di|) / m_i over the rows d that approach: of two bodies at
    a shared node m_a m_b / (m_a + m_b). All impulses follow from the same velocities. A free rigid body moves
    as a whole: along normals and along slips the mass is that of ``rigid_couplings``.
    """

    name = "impulse"
    uses_friction = True
    #: Whether rows whose sides separate are pushed apart as well.
    repels = False

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:  # noqa: ARG002
        return {"active": 0, "compliance": 0, "across": 0, "velocity": 1}

    def activate(self, rows: ContactRows, grid: Grid, *, moves: bool) -> None:  # noqa: ARG002
        """Write which rows take part; ``moves`` is false for a momentum that moves no point."""
        find_approach(rows, rows.count, rows.own, grid.spacing)

    def limit(self, rows: ContactRows, grid: Grid) -> FloatArray:  # noqa: ARG002
        """Return the largest normal impulse of every row (n,) [N s/m]; no rows where there is none."""
        return np.zeros(0)

    def impulses(self, rows: ContactRows, grid: Grid, work: FloatArray | None, *, projected: bool) -> None:
        """Stop what approaches, and slip within the cone."""
        own, n, free = rows.own, rows.count, len(rows.response) > 0
        if free:
            self.state.rigid.make_rigid(grid)
        rows.momentary_velocity(grid, own.velocity)
        self.activate(rows, grid, moves=work is not None)
        rows.couplings(own.active, grid, own.compliance)
        own.across[:n] = own.compliance[:n]
        if free:
            normal = rows.normal[:n]
            slip = own.velocity[:n] - np.vecdot(own.velocity[:n], normal)[:, None] * normal
            slip /= np.maximum(np.linalg.norm(slip, axis=1, keepdims=True), 1e-300)
            for direction, out in ((normal, own.compliance), (slip, own.across)):
                velocity = np.zeros((3, *grid.momentum.shape))
                rigid_couplings(rows, n, own.active, direction, grid.mass, velocity, out, grid.spacing)
        limit, gained = self.limit(rows, grid), np.zeros(0) if work is None else work
        stop(rows, n, own, limit, projected, gained, self.repels, grid.spacing)
