"""Contact of multiple velocity fields (Bardenhagen, Brackbill & Sulsky 2000; Bardenhagen et al. 2001).

S. G. Bardenhagen, J. E. Guilkey, K. M. Roessig, J. U. Brackbill, W. M. Witzel, J. C. Foster (2001), An
improved contact algorithm for the material point method and application to stress propagation in granular
material, CMES 2, 509-522 (not at hand; known by its abstract and Uintah's FrictionContactBard.cc), adds two
things to the contact of 2000. A node is in contact where the surface is compressed, or where it is free of
stress and the bodies approach. And impulses are scaled down where they would strain a body too much in a
step.

Assumed here. The traction is that of the pair, n·σ·n of both bodies' stress weighted by volume along the
pair's normal; in Uintah each body has a traction and a normal. The strain is J_n Δt / (m h) of the lighter
body; in Uintah it is the largest component of the whole velocity change, which depends on the axes.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from mpmfw.api import ContactRows, FloatArray, Grid, OptionsModel, Particles, Stencil
from mpmfw.contact.nodes import Nodes
from mpmfw.contact.shared_nodes import all_entries, point_of
from mpmfw.kernels import kernel
from mpmfw.kernels.contact import Rows
from mpmfw.kernels.types import Flags, Floats, Points, Table
from mpmfw_contact.impulse import Impulse


@kernel
def project_stress(
    table: Table, points: Points, shared: Flags, out: Floats, spacing: tuple[float, ...]
) -> None:
    """Σ_p φ_ip V_p σ_p at ``shared`` nodes into ``out`` (n_nodes, dim, dim) [Pa m^dim]; 0 at others."""
    dim, p = len(spacing), 0
    out[:] = 0.0
    for k in all_entries(table.row):
        i = table.nodes[k]
        if shared[i]:
            p = point_of(table.row, k, p)
            for d in range(dim):
                for e in range(dim):
                    out[i, d, e] += table.weight[k] * points.volume[p] * points.stress[p, d, e]


@kernel
def mark_compressed(
    rows: Rows, count: int, stress: Floats, compressed: Floats, spacing: tuple[float, ...]
) -> None:
    """Write 1 into ``compressed`` (n,) where n·(σ_a + σ_b)·n < 0 with the nodal ``stress``, else 0."""
    dim = len(spacing)
    for c in range(count):
        k, traction = rows.start[c], 0.0
        i, j = rows.dof[k], rows.dof[k + 1]  # of a rigid body no stress is projected
        for d in range(dim):
            for e in range(dim):
                traction += rows.normal[c, d] * (stress[i, d, e] + stress[j, d, e]) * rows.normal[c, e]
        compressed[c] = 1.0 if traction < 0.0 else 0.0


class TractionOptions(OptionsModel):
    """The two additions of 2001."""

    traction: bool = Field(
        False,
        description="bodies under a compressive normal traction stay in contact also where they separate "
        "(2001)",
    )
    largest_strain: float | None = Field(
        None,
        gt=0,
        description="strain of a step, of the lighter body, that bounds impulses (2001; Uintah has 0.5)",
    )


class Bardenhagen(Impulse):
    """Momentum exchange at grid nodes that two bodies share, with Coulomb friction.

    At a shared node with approaching bodies the relative velocity along the normal is taken away, and the
    tangential one within Coulomb's cone; of the projected and of the updated momentum.
    """

    name = "bardenhagen"
    Options = TractionOptions
    options: TractionOptions
    Detection = Nodes
    defaults: ClassVar[dict[str, str]] = {"criterion": "velocity"}

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.leaves_bodies_out = True  # rows have no history

    def row_arrays(self, *, friction: bool) -> dict[str, int | None]:
        arrays = super().row_arrays(friction=friction)
        if self.options.traction:
            arrays["compressed"] = 0
        return arrays

    def measure(self, rows: ContactRows, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Find the rows whose bodies are compressed, if the normal traction counts."""
        if not self.options.traction:
            return
        stress = np.zeros((*grid.momentum.shape, grid.dim))
        shared = np.zeros(len(grid.mass), dtype=bool)
        shared[rows.dof[: rows.start[rows.count]]] = True
        project_stress(phi, particles, shared, stress, grid.spacing)
        mark_compressed(rows, rows.count, stress, rows.own.compressed, grid.spacing)

    def activate(self, rows: ContactRows, grid: Grid, *, moves: bool) -> None:
        super().activate(rows, grid, moves=moves)
        if self.options.traction:
            own, n = rows.own, slice(rows.count)
            np.maximum(own.active[n], own.compressed[n], out=own.active[n])

    def limit(self, rows: ContactRows, grid: Grid) -> FloatArray:
        """Return the bound that the largest strain of a step sets."""
        if self.options.largest_strain is None:
            return super().limit(rows, grid)
        largest = self.options.largest_strain * self.cell_size / self.dt
        mass = grid.mass[rows.dof[: rows.start[rows.count]]]
        lighter = np.minimum.reduceat(np.where(mass > 0.0, mass, np.inf), rows.start[: rows.count])
        return np.asarray(largest * lighter)
