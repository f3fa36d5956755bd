"""Nodal forces of accelerations that are given at the material points."""

from abc import ABC, abstractmethod

import numpy as np

from mpmfw.api import FloatArray, Grid, State, Stencil, hookimpl


class PointForces(ABC):
    """f_i += Σ_p φ_ip m_p a_p, with the shape functions of the step."""

    name = "point_forces"

    @abstractmethod
    def acceleration(self, state: State, dt: float) -> FloatArray:
        """Return a_p (n, dim) [m/s²] in a step of ``dt`` [s]."""

    @hookimpl
    def after_momentum_projection(self, phi: Stencil) -> None:
        """Keep this step's table of shape functions."""
        self.phi = phi

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State, dt: float) -> None:
        """Add the forces of all points."""
        phi, force = self.phi, state.particles.mass[:, None] * self.acceleration(state, dt)
        point = np.repeat(np.arange(len(force)), np.diff(phi.row))
        np.add.at(grid.force, phi.nodes, phi.weight[:, None] * force[point])
