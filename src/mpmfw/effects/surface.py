"""Tracked surfaces: facets whose nodes move with the grid velocity that moves the body's points."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.arithmetic import add_scaled_row
from mpmfw.kernels.stencil import entries
from mpmfw.kernels.types import Floats, Indices, Ints, Table
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Acts, Effect, Setup
from mpmfw.state.fields import MIN_GAP, AnyArray, Field
from mpmfw.state.structs import Body, Grid, State
from mpmfw.state.surface import closed_surface, least_gaps, make_surface, moments_of

SurfaceMap = Literal["plain", "mass_weighted"]

#: Share of N² ρ h² below which a node counts as empty under the plain map.
LIGHT = 0.05

#: Mass m_c of the mass-weighted map, as a fraction of a full cell's mass ρ h².
CRITICAL_MASS = 0.1

#: Share of a full cell's mass, or in a thin body of what a cell can hold of it: surface nodes that have left
#: their points, with less round them, stay.
EMPTY = 1e-4


@kernel
def weigh_plain(
    row: Ints, nodes: Indices, weight: Floats, cell_mass: Floats, least: Floats, node_mass: Floats
) -> None:
    """Nodes with next to no mass get no weight, and the others' sum stays 1; untouched where all carry mass.

    Under a straight boundary that reaches into a cell by the share N, the node beyond has the mass N² ρ h² /
    2 (CPDI). A force on a node with less than a tenth of that would be all acceleration. ``cell_mass`` is ρ
    h² of the surface node's body; in a body thinner than a cell, four times the heaviest node's mass. Where
    all have less than ``least`` [kg/m], the node has left its points."""
    for s in range(len(row) - 1):
        lost, kept, heaviest, lightest, largest = 0.0, 0.0, 0.0, math.inf, 0.0
        for k in entries(row, s):
            lightest, largest = min(lightest, node_mass[nodes[k]]), max(largest, abs(weight[k]))
        if lightest > LIGHT * cell_mass[s] * largest * largest and lightest >= least[s]:
            continue
        for k in entries(row, s):
            heaviest = max(heaviest, node_mass[nodes[k]])
        if heaviest < least[s]:
            weight[row[s] : row[s + 1]] = 0.0
            continue
        light = LIGHT * min(cell_mass[s], 4.0 * heaviest)
        for k in entries(row, s):
            heavy = node_mass[nodes[k]] > light * weight[k] * weight[k]
            kept += weight[k] if heavy else 0.0
            lost += 0.0 if heavy else weight[k]
        if lost > 0.0 and kept > 0.0:
            for k in entries(row, s):
                heavy = node_mass[nodes[k]] > light * weight[k] * weight[k]
                weight[k] = weight[k] / kept if heavy else 0.0


@kernel
def weigh_by_mass(
    row: Ints, nodes: Indices, weight: Floats, cell_mass: Floats, least: Floats, node_mass: Floats
) -> None:
    """N_i ← N_i m_i / (m_i + m_c), scaled to the sum 1."""
    for s in range(len(row) - 1):
        total = 0.0
        for k in range(row[s], row[s + 1]):
            m = node_mass[nodes[k]]
            weight[k] *= m / (m + CRITICAL_MASS * cell_mass[s])
            total += weight[k]
        if total * CRITICAL_MASS * cell_mass[s] < least[s]:
            weight[row[s] : row[s + 1]] = 0.0
            continue
        for k in range(row[s], row[s + 1]):
            weight[k] /= total


@kernel
def move_points(
    table: Table, velocity: Floats, position: Floats, displacement: Floats, dt: float,
    spacing: tuple[float, ...],
) -> None:  # fmt: skip
    """x_s += Δt Σ N_i v_i."""
    motion = scratch.matrix((0.0,), spacing)
    for s in range(len(position)):
        for d in range(len(spacing)):
            motion[0, d] = 0.0
        for k in entries(table.row, s):
            add_scaled_row(motion, 0, table.weight[k], velocity, table.nodes[k], spacing)
        for d in range(len(spacing)):
            displacement[s, d] = dt * motion[0, d]
            position[s, d] += dt * motion[0, d]


def _filled(body: Body, area: float, cell_size: float) -> float:
    """Return the part of a cell that a body can fill: (4 V / S h)^dim, of a square its area; at most 1."""
    if body.rigid:
        return 1.0
    volume, centroid, _ = moments_of(body.outlines, body.facets)
    return float(min(1.0, 4.0 * volume / (area * cell_size)) ** len(centroid))


CELL_MASS = Field(
    "cell_mass", ("surface_node",), "kg m-1", "mass of a full cell of the surface node's body", "surface"
)


class SurfaceTracker:
    """Weighs the surface's table with the nodal masses, and moves the surface.

    The map ``plain`` keeps N_i, the boundary basis of CPDI and B-splines, but for nodes with next to no mass.
    ``mass_weighted`` is for linear and GIMP particles, whose boundary nodes may be empty."""

    name = "surface"

    def __init__(self, setup: Setup, surface_map: SurfaceMap, stage: str) -> None:
        self.map, self.stage, self.surface = surface_map, stage, setup.state.tracked_surface
        density = np.array([body.areal_density for body in setup.bodies])
        self.cell_mass = setup.allocate(self.name, CELL_MASS)
        self.cell_mass[:] = density[self.surface.body] * setup.cell_size**setup.dim
        if setup.state.grid.axisymmetric:
            self.cell_mass *= setup.state.grid.around(self.surface.position[:, 0])
        areas = [own.sum() for own in np.split(self.surface.tributary, self.surface.body_first[1:-1])]
        filled = np.array([_filled(*each, setup.cell_size) for each in zip(setup.bodies, areas, strict=True)])
        self.least = EMPTY * self.cell_mass * filled[self.surface.body]  #: mass of nodes that are not empty

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        contact, state = (setup.whole or setup).contact, setup.state
        by_contact = contact is not None and contact.needs_surface
        loaded = setup.loaded_sides or any(plugin.needs_surface for plugin in setup.named_plugins)
        stage = "contact" if by_contact else "force" if loaded else "gap"
        state.surface = make_surface(state.bodies, state.grid.n_fields, stage)
        chosen = contact.surface_map if contact is not None and by_contact else "auto"
        if chosen == "auto":
            chosen = "mass_weighted" if setup.massless_boundary else "plain"
        frames = setup.scene.output.surface
        line = Effect("surface frames", frames, "output.surface" if frames else "output.surface = false")
        reason = f"for {', '.join(setup.surface_users)}; map {chosen}"
        return Acts(reason, [cls(setup, chosen, stage)], [line])

    @hookimpl(tryfirst=True)
    def detect(self, grid: Grid) -> None:
        """Fit N_i(x_s) to the nodal masses, before any contact."""
        phi = self.surface.table
        row = phi.row[: self.surface.on_grid + 1]
        if self.map == "plain":
            weigh_plain(row, phi.nodes, phi.weight, self.cell_mass, self.least, grid.mass)
        else:
            weigh_by_mass(row, phi.nodes, phi.weight, self.cell_mass, self.least, grid.mass)

    @hookimpl
    def advect(self, grid: Grid, dt: float) -> None:
        surface, n = self.surface, self.surface.on_grid
        position, displacement = surface.position[:n], surface.displacement[:n]
        move_points(surface.table, grid.velocity, position, displacement, dt, grid.spacing)


class GapDiagnostic:
    """``min_gap``: measured between the surfaces in the same way for every method."""

    name = "gap"
    stage = "gap"

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:  # noqa: ARG003
        return Acts("output.gap", [cls()])

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [MIN_GAP]

    @hookimpl
    def diagnostics(self, state: State) -> dict[str, AnyArray]:
        """Least of both bodies' node-to-facet distances, (pair,) [m]."""
        first, second = np.ascontiguousarray(state.pair_bodies.T)
        gaps = least_gaps(closed_surface(state.tracked_surface), first, second, state.grid.spacing)
        if state.self_contact is not None:
            gaps = np.minimum(gaps, state.self_contact.gaps(state.pair_bodies))
        return {"min_gap": gaps}
