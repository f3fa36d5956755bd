"""Impulses at single rows: what approaches is stopped, and slip as far as Coulomb's cone lets it (Bardenhagen et al. 2001)."""

from __future__ import annotations

import numpy as np

from mpmfw.api import ContactRows, FloatArray, Grid, ImpulseLaw, Setup, State
from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.contact import couplings
from mpmfw.kernels.types import Floats, Ints


@kernel
def find_approach(
    count: int, gap: Floats, normal: Floats, velocity: Floats, active: Floats, spacing: tuple[float, ...]
) -> None:
    """1 for rows that touch and whose sides approach, else 0: all decided before anything moves."""
    for c in range(count):
        approach = 0.0
        for d in range(len(spacing)):
            approach -= velocity[c, d] * normal[c, d]
        active[c] = 1.0 if gap[c] <= 0.0 and approach > 0.0 else 0.0


@kernel
def stop(
    count: int, pair: Ints, normal: Floats, velocity: Floats, active: Floats, compliance: Floats, friction: Floats,
    projected: bool, impulse: Floats, work: Floats, spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """J_n = m approach, J_t = min(μ J_n, m |Δv_t|), with m the inverse of the row's ``compliance``.

    The work of J_t is its product with the slip: with the mean of before and after where the momentum is as
    ``projected``, and with what is left at the end of the step where it is updated, since J_t then acts beside the forces
    of the step. Bodies that stick have no slip left, and friction does no work. A ``work`` without pairs is not wanted.
    """
    dim = len(spacing)
    slip = scratch.vector(spacing)
    for c in range(count):
        for d in range(dim):
            impulse[c, d] = 0.0
        if active[c] == 0.0 or compliance[c] == 0.0:
            continue
        approach, square = 0.0, 0.0
        for d in range(dim):
            approach -= velocity[c, d] * normal[c, d]
        for d in range(dim):
            slip[d] = velocity[c, d] + approach * normal[c, d]
            square += slip[d] * slip[d]
        speed, normal_impulse = square**0.5, approach / compliance[c]
        tangential = min(friction[pair[c]] * normal_impulse, speed / compliance[c])
        for d in range(dim):
            direction = slip[d] / speed if speed > 0.0 else 0.0
            impulse[c, d] = normal_impulse * normal[c, d] - tangential * direction
        left = speed - tangential * compliance[c]
        if len(work) > 0:
            work[pair[c]] += tangential * (0.5 * (speed + left) if projected else left)


class Impulse(ImpulseLaw):
    """Every row by itself; nodes that several rows share are shared out between those that approach.

    The mass of row c is 1 / Σ_i |b_ci| (Σ_d |b_di|) / m_i over the rows d that approach: of two bodies at a shared node it is
    m_a m_b / (m_a + m_b), and where one body touches several others its mass is divided between them. All impulses are
    taken from the same velocities, so that the order of the bodies does not matter.
    """

    name = "impulse"
    uses_friction = True

    def row_arrays(self, *, friction: bool) -> dict[str, int]:  # noqa: ARG002
        """Rows that take part, their compliance, and their velocity."""
        return {"active": 0, "compliance": 0, "velocity": 1}

    def prepare(self, setup: Setup, owner: str) -> None:  # noqa: ARG002
        """Friction of the pairs."""
        self.list_pairs(setup.state)

    def list_pairs(self, state: State) -> None:
        """Friction of all pairs."""
        self.friction = np.array([pair.friction for pair in state.pairs], dtype=float)

    def impulses(
        self, rows: ContactRows, grid: Grid, scratch: FloatArray, work: FloatArray | None, *, projected: bool
    ) -> None:
        """Stop what approaches, and slip within the cone."""
        own, spacing = rows.own, grid.spacing
        rows.momentary_velocity(grid, own["velocity"])
        find_approach(rows.count, rows.gap, rows.normal, own["velocity"], own["active"], spacing)
        couplings(
            0,
            rows.count,
            rows.start,
            rows.dof,
            rows.weight,
            own["active"],
            grid.mass,
            scratch,
            own["compliance"],
        )
        stop(
            rows.count, rows.pair, rows.normal, own["velocity"], own["active"], own["compliance"], self.friction,
            projected, rows.force, np.zeros(0) if work is None else work, spacing,
        )  # fmt: skip
