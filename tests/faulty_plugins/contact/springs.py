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
