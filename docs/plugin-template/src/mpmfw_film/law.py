# src/mpmfw_film/law.py
"""The law: its options, its kernels, and its place among the rows of contact."""

from __future__ import annotations

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from mpmfw.api.contact import ContactRows, ImpulseLaw
from mpmfw.api.types import FloatArray, Grid
from mpmfw.kernels import Floats, Struct, kernel, scratch
from mpmfw.kernels.contact import Rows, slip_limit


class FilmOptions(BaseModel):
    """Options of the film."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    resistance: float = Field(
        0.0, ge=0.0, description="viscosity of the film over its thickness [Pa s/m]", examples=[1e4]
    )


class Own(Struct):
    """What the law keeps of n rows."""

    active: Floats  #: (n,) 1 where bodies touch and approach, else 0
    compliance: Floats  #: (n,) 1 / m, m the mass that the row moves [1/kg]
    velocity: Floats  #: (n, dim) Δv [m/s]


@kernel
def find_approach(rows: Rows, count: int, own: Own, spacing: tuple[float, ...]) -> None:
    """1 where bodies touch and approach, else 0: all decided before anything moves."""
    for c in range(count):
        approach = 0.0
        for d in range(len(spacing)):
            approach -= own.velocity[c, d] * rows.normal[c, d]
        own.active[c] = 1.0 if rows.gap[c] <= 0.0 and approach > 0.0 else 0.0


@kernel
def exchange(rows: Rows, count: int, own: Own, drag: float, work: Floats, spacing: tuple[float, ...]) -> None:
    """J_n = −m Δv·n, and J_t = min(μ J_n + a + ``drag`` A |Δv_t|, m |Δv_t|) against the slip Δv_t.

    ``drag`` is c Δt [Pa s²/m]. ``work`` (pair,) gets what J_t takes [J/m]; without pairs it is not asked for.
    """
    dim = len(spacing)
    slip = scratch.vector(spacing)
    for c in range(count):
        for d in range(dim):
            rows.force[c, d] = 0.0
        if own.active[c] == 0.0 or own.compliance[c] == 0.0:
            continue
        p, m, approach, square = rows.pair[c], 1.0 / own.compliance[c], 0.0, 0.0
        for d in range(dim):
            approach -= own.velocity[c, d] * rows.normal[c, d]
        for d in range(dim):
            slip[d] = own.velocity[c, d] + approach * rows.normal[c, d]
            square += slip[d] * slip[d]
        speed = square**0.5
        bound = slip_limit(rows, c, m * approach)
        tangential = min(bound + drag * rows.area[c] * speed, m * speed)
        for d in range(dim):
            along = slip[d] / speed if speed > 0.0 else 0.0
            rows.force[c, d] = m * approach * rows.normal[c, d] - tangential * along
        if len(work) > 0:
            work[p] += tangential * (speed - tangential / m)


class Film(ImpulseLaw):
    """Coulomb friction and a viscous film wherever two bodies touch."""

    name = "film"
    Options = FilmOptions
    options: FilmOptions
    uses_friction = True

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:  # noqa: ARG002
        """Arrays of :class:`Own`: numbers of a row, and one vector."""
        return {"active": 0, "compliance": 0, "velocity": 1}

    def impulses(self, rows: ContactRows, grid: Grid, work: FloatArray | None, *, projected: bool) -> None:
        """Return the rows' impulses from the grid's momentum; the film acts once a step, at its update."""
        own, spacing = rows.own, grid.spacing
        rows.momentary_velocity(grid, own.velocity)
        find_approach(rows, rows.count, own, spacing)
        rows.couplings(own.active, grid, own.compliance)
        drag = 0.0 if projected or work is None else self.options.resistance * self.state.dt
        exchange(rows, rows.count, own, drag, np.zeros(0) if work is None else work, spacing)
