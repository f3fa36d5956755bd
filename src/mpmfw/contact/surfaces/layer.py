"""The surface layer's inertia: nodes of the interface carry mass ([H17] section 3.1)."""

from __future__ import annotations

import numpy as np

from mpmfw.kernels import kernel, struct
from mpmfw.kernels.particle_grid import project, velocity_of_momentum
from mpmfw.kernels.types import Floats, Table
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import Setup
from mpmfw.state.fields import Field, FloatArray
from mpmfw.state.structs import Grid

MASS = Field("interface_mass", ("surface_node",), "kg m-1", "mass of the surface layer", "surface")
VELOCITY = Field(
    "interface_velocity", ("surface_node", "axis"), "m s-1", "velocity of the surface layer", "surface"
)


@kernel
def gather_layer(
    table: Table, node_velocity: Floats, node_start_velocity: Floats, velocity: Floats, flip: float
) -> None:
    """v_s ← flip (v_s + Σ N (v_i − v_i⁰)) + (1 − flip) Σ N v_i, as the material points do."""
    for s in range(len(velocity)):
        for d in range(velocity.shape[1]):
            new, increment = 0.0, 0.0
            for k in range(table.row[s], table.row[s + 1]):
                i, weight = table.nodes[k], table.weight[k]
                new += weight * node_velocity[i, d]
                increment += weight * (node_velocity[i, d] - node_start_velocity[i, d])
            velocity[s, d] = flip * (velocity[s, d] + increment) + (1.0 - flip) * new


class InterfaceLayer:
    """A layer of a ``thickness`` [m]: a surface node has the mass ρ l_trib thickness."""

    name = "surface_layer"
    stage = "contact"

    def __init__(self, thickness: float) -> None:
        self.thickness = thickness

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [MASS, VELOCITY]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        surface = self.surface = setup.state.tracked_surface
        self.state, self.flip = setup.state, setup.flip
        density = np.array([0.0 if body.rigid else body.areal_density for body in setup.bodies])
        self.mass: FloatArray = setup.allocate(self.name, MASS)
        self.mass[:] = self.thickness * density[surface.body] * surface.tributary
        if setup.state.grid.axisymmetric:
            self.mass *= setup.state.grid.around(surface.position[:, 0])
        self.velocity: FloatArray = setup.allocate(self.name, VELOCITY)
        self.points = struct(mass=self.mass, velocity=self.velocity)

    @hookimpl
    def after_momentum_projection(self, grid: Grid) -> None:
        """Add mass and momentum; at time zero the layer starts with its body."""
        table, start = self.surface.table, grid.start_velocity
        if self.state.steps == 0:
            gather_layer(table, start, start, self.velocity, 0.0)
        project(self.points, self.surface.position, None, table, grid, grid.mass, grid.spacing)
        velocity_of_momentum(grid.mass, grid.momentum, grid.start_velocity, grid.spacing)

    @hookimpl
    def after_second_projection(self, grid: Grid) -> None:
        """Add the momentum to MUSL's second projection."""
        surface = self.surface
        project(self.points, surface.position, None, surface.table, grid, None, grid.spacing)

    @hookimpl
    def advect(self, grid: Grid) -> None:
        gather_layer(self.surface.table, grid.velocity, grid.start_velocity, self.velocity, self.flip)
