"""Impulses of all rows at once: no approach beyond the gap, and Coulomb's cone as it is, without a stiffness.

Source: the time stepping is that of J. J. Moreau (1988), Unilateral contact and dry friction in finite
freedom dynamics, and M. Jean (1999), The non-smooth contact dynamics method; the projections are those of P.
Alart & A. Curnier (1991), A mixed formulation for frictional contact problems prone to Newton like solution
methods. The cone is round, not the pyramid of linear complementarity problems.

Assumed here is its place in a step of MPM. The whole impulse is that of the updated momentum, where all
forces have acted; with USF the projected momentum is met as well, and with MUSL the second. What is open
by g may close by g and no more, so that a first touch leaves no overlap. An overlap, from the scene or by
a turn of the surface, is not taken back, unless ``recovery`` names the share of it that a step takes: that
makes energy of nothing.
"""

from __future__ import annotations

import numpy as np
from pydantic import Field

from mpmfw.api import ContactRows, FloatArray, Grid, ImpulseLaw, OptionsModel, Setup, State, hookimpl
from mpmfw.api import Field as ArrayField
from mpmfw.contact.surfaces import Surfaces
from mpmfw_contact._gauss_seidel import add_friction_work, solve, state_problem

#: Default tolerance by dimension: faces that lie on each other in space take four times as many sweeps to
#: 1e-3, and rebound alike within 1e-4.
TOLERANCE = {2: 1e-3, 3: 5e-3}

#: By how many times the tolerance a solution may miss it without a warning.
MISSED = 10.0

_SWEEPS = "mean number of sweeps in a solution since the last output"
_RESIDUAL = "largest change of a row in a last sweep since the last output, over the largest velocity"
SOLVER_SERIES = (
    ArrayField("solver_sweeps", (), "1", _SWEEPS, "series", output=True),
    ArrayField("solver_residual", (), "1", _RESIDUAL, "series", output=True),
)

#: Part of an open place's area that lies across the normal, from which it takes part: the normal ahead of a
#: corner that slides is along the face, and would stop it.
FACING = 0.9


class LcpOptions(OptionsModel):
    tolerance: float | None = Field(
        None, gt=0, lt=1, description="change of a row's velocity that ends the sweeps, over the largest; if "
        "left out, 1e-3 in 2D and 5e-3 in 3D",
    )  # fmt: skip
    sweeps: int = Field(500, ge=1, description="most sweeps, to and fro, in a solution")
    recovery: float = Field(0.0, ge=0, le=1, description="share of an overlap that a step takes back")


class Lcp(ImpulseLaw):
    """0 ≤ g / Δt + u_n ⊥ J_n ≥ 0 and Coulomb's cone in all rows at once, by projected Gauss-Seidel from the
    forces of the last step."""

    name = "lcp"
    Options = LcpOptions
    options: LcpOptions
    uses_friction = True
    waits_for_forces = True
    history = ("identity", "force", "solutions", "unfinished", "worst", "since", "swept", "residual")

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:  # noqa: ARG002
        return {"compliance": 0, "allowed": 0, "velocity": 1, "before": 1, "direction": 1}

    def prepare(self, setup: Setup) -> None:
        given = self.options.tolerance
        self.tolerance = TOLERANCE[setup.dim] if given is None else given
        self.velocity = np.zeros((0, setup.dim))
        self.identity, self.force = np.zeros(0, dtype=np.int64), np.zeros((0, setup.dim))
        self._begin_count()

    def _begin_count(self) -> None:
        """Count solutions, and sweeps since the last output, from zero."""
        self.solutions, self.unfinished, self.worst = 0, 0, 0.0
        self.since, self.swept, self.residual = 0, 0, 0.0

    def impulses(self, rows: ContactRows, grid: Grid, work: FloatArray | None, *, projected: bool) -> None:
        if len(self.velocity) != len(grid.mass):
            self.velocity = np.zeros_like(grid.momentum)
        own, options, spacing = rows.own, self.options, grid.spacing
        self._begin(rows, anew=work is None)
        fastest = state_problem(
            rows, rows.count, own, grid.mass, grid.momentum, self.velocity, 1.0 / self.dt, options.recovery,
            FACING, spacing
        )  # fmt: skip
        sweeps, change = solve(
            rows, rows.count, own, grid.mass, self.velocity, fastest, self.tolerance, options.sweeps,
            spacing,
        )  # fmt: skip
        self.solutions += 1
        self.since, self.swept = self.since + 1, self.swept + min(sweeps, options.sweeps)
        self.residual = max(self.residual, change)
        if sweeps > options.sweeps and change > MISSED * self.tolerance:
            self.unfinished += 1
            self.worst = max(self.worst, change)
        if work is not None:
            n = rows.count
            self.identity, self.force = rows.identity[:n].copy(), rows.force[:n] / self.dt
            add_friction_work(rows, rows.count, own, self.velocity, projected, work, spacing)

    def _begin(self, rows: ContactRows, *, anew: bool) -> None:
        """Impulses to begin with: those of the last step, where the place was there, else none."""
        n = rows.count
        rows.force[:n] = 0.0
        if anew or len(self.identity) == 0:
            return
        place = np.minimum(np.searchsorted(self.identity, rows.identity[:n]), len(self.identity) - 1)
        same = self.identity[place] == rows.identity[:n]
        rows.force[:n][same] = self.force[place[same]] * self.dt

    def restart(self) -> None:
        super().restart()
        self._begin_count()

    @hookimpl
    def declare_fields(self) -> list[ArrayField]:
        return [*super().declare_fields(), *SOLVER_SERIES]

    @hookimpl
    def diagnostics(self, state: State, interval: float) -> dict[str, FloatArray]:
        sweeps, residual = np.array(self.swept / max(self.since, 1)), np.array(self.residual)
        self.since, self.swept, self.residual = 0, 0, 0.0
        return {
            **super().diagnostics(state, interval), "solver_sweeps": sweeps, "solver_residual": residual
        }  # fmt: skip

    @hookimpl
    def concerns(self) -> list[str]:
        if self.unfinished == 0:
            return super().concerns()
        return [
            *super().concerns(),
            f"contact law 'lcp': {self.unfinished} of {self.solutions} solutions ended after sweeps = "
            f"{self.options.sweeps} with rows that still changed by up to {self.worst:.1g} of the largest; "
            f"expected {self.tolerance:g}",
        ]


class LcpContact(Lcp):
    """Rows between surfaces, solved at once."""

    Detection = Surfaces
