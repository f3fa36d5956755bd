"""Logarithmic barriers between surfaces, in explicit steps and therefore without IPC's guarantee.

Sources: M. Li et al. (2020), Incremental potential contact: intersection- and inversion-free,
large-deformation dynamics, ACM Trans. Graph. 39 (4), 49; with material points X. Li, Y. Fang, M. Li, C. Jiang
(2022), BFEMP: Interpenetration-free MPM-FEM coupling with barrier contact, CMAME 390, 114350. Known here by
their abstracts and the public code of the IPC Toolkit. Published are the barrier −(d − d̂)² ln(d / d̂) of the
distance d < d̂, friction lagged by a step, and implicit steps whose line search ends before collision
detection finds a contact.

Assumed here is all that explicit steps need. The barrier's stiffness limits the step. So does collision
detection: as all move at the step's beginning, a node uses up at most half of its distance from a facet. A
run in which forces carry a node past a barrier ends and says where. Friction is a spring with a history; on
the published dashpot a body would creep. The energy per area is κ M d̂ b(d / d̂). Bodies that begin closer
than d̂ begin without a force: their distances count from there, by one offset for all that are so joined. A
node meets one facet of a body, the closest that faces it; published are all.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import Field
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from mpmfw.api import ContactRows, FloatArray, Grid, PairRecords, Setup, State
from mpmfw.contact.springs import SpringLaw, SpringOptions
from mpmfw.contact.surfaces import Surfaces
from mpmfw_contact._barriers import barrier_forces, set_barriers, time_to_touch

#: b'' where −b' is a thousandth.
FIRST = 0.11


class BarrierLawOptions(SpringOptions):
    kappa: float = Field(
        0.3,
        gt=0,
        description="stiffness factor: pressure -kappa M b'(d / r) at the distance d, b(s) = -(1 - s)^2 ln s",
    )
    tangential_ratio: float = Field(1.0, gt=0, description="k_t over kappa M A / r")
    reach: float = Field(0.1, gt=0, le=0.5, description="distance r in cells from which barriers act")


class BarrierLaw(SpringLaw):
    """f_n = −κ M A b'(d / r) where a place is nearer than r to a facet, with friction that has a history."""

    name = "barrier"
    Options = BarrierLawOptions
    options: BarrierLawOptions
    needs = frozenset({"gap", "facets", "nodes"})
    history = ("offset", "placed")
    dimensions = (2,)
    dimensions_note = (
        "in space edges cross edges with no node near a facet, where bodies would interpenetrate"
    )

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:
        return {**super().row_arrays(friction=friction), "distance": 0}

    def prepare(self, setup: Setup) -> None:
        self.surface = setup.state.tracked_surface
        self.threshold = self.options.reach * setup.cell_size
        self.offset, self.placed = np.zeros(0), False
        #: Bodies that the scene puts together have one number, and one offset.
        self.group, self.group_offset = np.arange(len(setup.bodies)), np.zeros(len(setup.bodies))
        super().prepare(setup)

    def range(self) -> float:
        return self.threshold

    def compliance(self) -> None:
        """Return None: barriers give by no more than their reach."""

    def estimate_frequency(self, bulk_frequency: float) -> float:
        """Return the frequency of a place where barriers give a pressure of a thousandth of κ M."""
        return FIRST / self.options.reach * super().estimate_frequency(bulk_frequency)

    def list_pairs(self, state: State) -> None:
        super().list_pairs(state)
        first, second = state.pair_bodies.T
        together = self.group[first] == self.group[second]
        self.offset = np.where(together, self.group_offset[self.group[first]], 0.0)

    def stiffness(self, rows: ContactRows, old: ContactRows) -> FloatArray:  # noqa: ARG002
        """Return κ M A b'' / r where the row may come to in the step."""
        if self.state.steps == 0 and not self.placed:
            self._join_bodies(rows)
        worst = set_barriers(
            rows, rows.count, rows.own, self.modulus, self.offset, self.threshold, self.cell_size,
            self.options.tangential_ratio if len(rows.own.tangential) else 0.0,
        )  # fmt: skip
        if worst >= 0:
            pair, node = self.state.pairs[int(rows.pair[worst])], int(rows.places.slave[worst])
            text = f"{pair.label}: a surface node came past its barrier within a step"
            advice = f"a smaller time.safety, or a larger contact.{self.law_name}.kappa or .reach"
            raise self.state.error_at(node, text, surface=True, advice=advice)
        return rows.own.limit_k  # type: ignore[no-any-return]

    def _join_bodies(self, rows: ContactRows) -> None:
        """Number the groups of bodies closer than barriers reach, and count their distances from there."""
        gaps, n_bodies = np.full(len(self.offset), self.threshold), len(self.group)
        np.minimum.at(gaps, rows.pair[: rows.count], rows.gap[: rows.count])
        first, second = self.state.pair_bodies.T
        near = gaps < self.threshold
        graph = coo_matrix((near[near], (first[near], second[near])), shape=(n_bodies, n_bodies))
        self.group = connected_components(graph, directed=False)[1]
        np.maximum.at(self.group_offset, self.group[first], np.where(near, self.threshold - gaps, 0.0))
        self.list_pairs(self.state)

    def longest_step(self, rows: Any, grid: Grid) -> float:
        """Return the time in which no node uses up half of its distance, as all move now [s]."""
        return time_to_touch(
            rows, rows.count, rows.places, self.surface, self.surface.table, self.offset, self.threshold,
            grid.mass, grid.momentum, grid.spacing,
        )  # fmt: skip

    def normal_forces(self, rows: ContactRows, old: ContactRows, records: PairRecords) -> None:
        self.placed = True
        barrier_forces(
            rows, rows.count, rows.own, old.own, self.modulus, self.threshold, self.cell_size,
            self.options.tangential_ratio, records,
        )  # fmt: skip


class Barrier(BarrierLaw):
    """Barriers between surfaces; a run in which a step carries a node past one ends and says where."""

    Detection = Surfaces
