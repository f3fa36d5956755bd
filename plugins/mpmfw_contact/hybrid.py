"""Impulses that a spring bounds: overlapping bodies exchange no more than a penalty force gives in the step.

Source: J. E. Guilkey, R. Lander, L. Bonnell (2021), A hybrid penalty and grid based contact method for the
material point method, CMAME 379, 113739 (not at hand), known from the public code of Uintah (branch
yoyodyne, Materials/Contact/PenaltyContact.cc and LineSegment/LSTasks.cc). There the penalty force of surface
points is mapped to the nodes, its direction is the normal, and the velocity of a body at a node changes by
the lesser of what the force would give and of what takes it to the velocity of the centre of mass; friction
is the lesser of μ times that and of what stops the slip. The stiffness is 10 K_1 K_2 / (K_1 + K_2) of the
bulk moduli, times a segment's length in a cell as deep as it is wide. Bodies that overlap and separate are
pushed as well, since the lesser is that of sizes.

Assumed here. The cap is that of a row, so that impulses are equal and opposite; there it is a body's at a
node. All overlaps act; there those below 0.1 cells do. The limit of 0.1 on a step's strain is left out.
"""

from __future__ import annotations

import numpy as np
from pydantic import Field

from mpmfw.api import ContactRows, FloatArray, Grid, OptionsModel, State
from mpmfw.contact.surfaces import Surfaces
from mpmfw_contact.impulse import Impulse


class HybridOptions(OptionsModel):
    kappa: float = Field(
        10.0,
        gt=0,
        description="stiffness factor: k = kappa K area / h, K = K_1 K_2 / (K_1 + K_2) of the bulk moduli",
    )


class Hybrid(Impulse):
    """J_n = min(k |g| Δt, m |Δv_n|) on every row that overlaps, and J_t = min(μ J_n, m |Δv_t|).

    The mass m is that of :class:`~mpmfw_contact.impulse.Impulse`. The impulse is that of the updated
    momentum, as published, and of MUSL's second.
    """

    name = "hybrid"
    Options = HybridOptions
    options: HybridOptions
    needs = frozenset({"gap", "facets"})
    softness_option = "kappa"
    repels = True
    waits_for_forces = True

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:
        return {**super().row_arrays(friction=friction), "limit": 0}

    def list_pairs(self, state: State) -> None:
        super().list_pairs(state)
        both = [
            (state.bodies[pair.first].bulk_modulus, state.bodies[pair.second].bulk_modulus)
            for pair in state.pairs
        ]
        reduced = [a * b / (a + b) if np.isfinite(a + b) else min(a, b, 1e300) for a, b in both]
        self.modulus: FloatArray = self.options.kappa * np.array(reduced, dtype=float) / self.cell_size

    def compliance(self) -> FloatArray:
        """h / (κ K), overlap under a unit of pressure, of every pair [m/Pa]."""
        return 1.0 / self.modulus

    def activate(self, rows: ContactRows, grid: Grid, *, moves: bool) -> None:
        """Push rows that overlap; MUSL's second momentum is only stopped."""
        if moves:
            rows.own.active[: rows.count] = rows.gap[: rows.count] <= 0.0
        else:
            super().activate(rows, grid, moves=moves)

    def limit(self, rows: ContactRows, grid: Grid) -> FloatArray:  # noqa: ARG002
        n, limit = slice(rows.count), rows.own.limit
        limit[n] = self.modulus[rows.pair[n]] * rows.area[n] * np.maximum(-rows.gap[n], 0.0) * self.dt
        return limit  # type: ignore[no-any-return]


class HybridContact(Hybrid):
    """Rows between surfaces, each stopped by no more than its spring's impulse."""

    Detection = Surfaces
