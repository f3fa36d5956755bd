"""Springs whose areas, histories, dashpots or records are wrong: the bundled law, spoiled in one place."""

from __future__ import annotations

from typing import Any

from mpmfw.api import hookimpl
from mpmfw_contact.penalty import Penalty, PenaltyLaw


class PerPointLaw(PenaltyLaw):
    def stiffness(self, rows, old):
        super().stiffness(rows, old)
        n = rows.count
        for k in (rows.own.k, rows.own.limit_k):
            k[:n] *= 0.5 * self.cell_size / rows.tributary_area[:n]
        return rows.own.limit_k


class PerPoint(Penalty):
    """Every point has half a cell of the surface, however many points there are."""

    name = "per-point"
    Law = PerPointLaw


class HalfTheWork(Penalty):
    """Reports half of the work of friction."""

    name = "half-the-work"

    @hookimpl
    def diagnostics(self, state, interval) -> dict[str, Any]:
        series = Penalty.diagnostics(self, state, interval)
        series["frictional_work"] = 0.5 * series["frictional_work"]
        return series


class FirstPairLaw(PenaltyLaw):
    def forces(self, rows, old, dashpot, records) -> None:
        super().forces(rows, old, dashpot, records)
        if len(rows.own.tangential):
            rows.own.tangential[: rows.count][rows.pair[: rows.count] > 0] = 0.0


class FirstPairHistory(Penalty):
    """Friction has a history between the first two bodies alone."""

    name = "first-pair-history"
    Law = FirstPairLaw


class FadingLaw(PenaltyLaw):
    def forces(self, rows, old, dashpot, records) -> None:
        super().forces(rows, old, dashpot, records)
        rows.own.tangential[: rows.count] *= 0.7


class FadesPerStep(Penalty):
    """Springs of friction lose three tenths of their load in every step, however long that is."""

    name = "fades-per-step"
    Law = FadingLaw


class ForgetsAtOutputs(Penalty):
    """Springs of friction lose their load when somebody asks for the series."""

    name = "forgets-at-outputs"

    @hookimpl
    def diagnostics(self, state, interval) -> dict[str, Any]:
        self.old.own.tangential.fill(0.0)
        return Penalty.diagnostics(self, state, interval)


class ForgetsSprings(Penalty):
    """At time zero the springs of friction lose their load."""

    name = "forgets-springs"

    def restart(self) -> None:
        super().restart()
        self.old.own.tangential.fill(0.0)


class ShallowReach(Penalty):
    """Loses points that are deeper than a twenty-fifth of a cell."""

    name = "shallow-reach"

    def find_rows(self, grid, phi, particles) -> None:
        super().find_rows(grid, phi, particles)
        gap = self.rows.gap[: self.rows.count]
        gap[gap < -0.04 * grid.cell_size] = 1e-6 * grid.cell_size
