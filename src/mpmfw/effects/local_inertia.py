"""Local inertia correction ("k2"): two terms of the full mass matrix's series, on the acceleration alone.

a_i += 1/m_i Σ_p m_p φ_ip (a_i − Σ_j φ_jp a_j). It mends bending as well as rotation and honours boundary
conditions, but its stability limit is lower: a Courant number of 0.4.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.fields import Field, FloatArray
from mpmfw.hookspecs import hookimpl
from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.types import Floats, Indices, Ints
from mpmfw.setup import Setup
from mpmfw.state import Body, Grid, Particles, State, Stencil

if TYPE_CHECKING:
    from mpmfw.effects.constraint import Constraint

#: Largest Courant number c Δt / h at which the correction was found stable.
COURANT_LIMIT = 0.4

NODAL_FIELDS = [
    Field("acceleration", ("node", "axis"), "m s-2", "nodal acceleration over the step", "grid"),
    Field("correction", ("node", "axis"), "kg m s-2 m-1", "local inertia correction", "grid"),
]


@kernel
def correct_locally(
    first_particle: int,
    last_particle: int,
    first_node: int,
    last_node: int,
    row: Ints,
    nodes: Indices,
    weight: Floats,
    mass: Floats,
    node_mass: Floats,
    node_start_velocity: Floats,
    held_momentum: Floats,
    node_momentum: Floats,
    acceleration: Floats,
    correction: Floats,
    spacing: tuple[float, ...],
) -> None:
    """(m v)_i += Σ_p m_p φ_ip (Δv_i − Σ_j φ_jp Δv_j), Δv_i the node's velocity change in this step.

    Δv_i is that of ``held_momentum``, in which boundary conditions are met: a node that is held pulls at no other.
    """
    dim = len(spacing)
    mean = scratch.vector(spacing)
    for i in range(first_node, last_node):
        for d in range(dim):
            correction[i, d] = 0.0
            acceleration[i, d] = 0.0
            if node_mass[i] > 0.0:
                acceleration[i, d] = held_momentum[i, d] / node_mass[i] - node_start_velocity[i, d]
    for p in range(first_particle, last_particle):
        for d in range(dim):
            mean[d] = 0.0
        for k in range(row[p], row[p + 1]):
            for d in range(dim):
                mean[d] += weight[k] * acceleration[nodes[k], d]
        for k in range(row[p], row[p + 1]):
            for d in range(dim):
                correction[nodes[k], d] += mass[p] * weight[k] * (acceleration[nodes[k], d] - mean[d])
    for i in range(first_node, last_node):
        for d in range(dim):
            node_momentum[i, d] += correction[i, d]


class LocalInertia:
    """The correction for every body with ``rotation = "local"``.

    Parameters
    ----------
    bodies
        Those that are corrected.
    constraint
        Boundary conditions, where one of the bodies has prescribed sides.
    """

    name = "local_inertia"
    ledger_term = ("inertia", "local inertia")

    def __init__(self, bodies: tuple[Body, ...], constraint: Constraint | None = None) -> None:
        self.bodies, self.constraint = bodies, constraint
        self.frame = -1

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """Nodal scratch."""
        return NODAL_FIELDS

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Know the cell size and where arrays are listed."""
        self.state, self.cell_size = setup.state, setup.cell_size

    def _fit(self, grid: Grid) -> None:
        """Fit the nodal arrays to the windows whenever these were laid anew."""
        if self.frame != grid.frame:
            self.frame = grid.frame
            self.acceleration: FloatArray = np.zeros_like(grid.momentum)
            self.correction: FloatArray = np.zeros_like(grid.momentum)
            self.state.arrays[f"{self.name}/acceleration"] = self.acceleration
            self.state.arrays[f"{self.name}/correction"] = self.correction

    @hookimpl
    def correct_inertia(self, grid: Grid, phi: Stencil, particles: Particles) -> None:
        """Correct each body's own velocity field."""
        self._fit(grid)
        held = grid.momentum
        if self.constraint is not None:
            held = self.constraint.held_momentum(grid)
        for body in self.bodies:
            nodes = grid.field_nodes(body.field)
            correct_locally(
                body.particles.start,
                body.particles.stop,
                nodes.start,
                nodes.stop,
                phi.row,
                phi.nodes,
                phi.weight,
                particles.mass,
                grid.mass,
                grid.start_velocity,
                held,
                grid.momentum,
                self.acceleration,
                self.correction,
                grid.spacing,
            )

    @hookimpl
    def stable_timestep(self, state: State) -> tuple[float, str]:
        """Courant number at most 0.4."""
        fastest = max(body.wave_speed for body in self.bodies)
        return COURANT_LIMIT * state.grid.cell_size / fastest, "local inertia correction"
