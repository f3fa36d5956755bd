"""Linear shape functions: the original material point method (Sulsky, Chen & Schreyer 1994)."""

from __future__ import annotations

import numpy as np

from mpmfw.api import FloatArray, Grid, Particles, Setup, Stencil, check_inside, empty_stencil, hookimpl
from mpmfw.kernels.stencil import fill_linear
from mpmfw_shape._bilinear_surface import LinearSurface


class Linear(LinearSurface):
    """φ_ip = N_i(x_p): 4 nodes in 2D, 8 in 3D. ∇φ jumps at cell faces ("grid-crossing noise"); MUSL is the
    stable scheme. The correction of spin by cells would feed the noise (impacts gain up to 20 % of their energy), and with lumped
    inertia a fast spin gains up to 9 %: a body turns as a whole."""

    name = "linear"
    massless_boundary = True
    singular_spread = True
    auto_scheme = "musl"
    auto_transfer = "flip"
    auto_rotation = "exact"

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Allocate the table."""
        self.table = empty_stencil(setup.state.particles.count, 2**setup.dim, setup.dim)

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:
        """Points have no extent."""
        return np.zeros_like(particles.position)

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """N_i(x_p) and ∇N_i(x_p)."""
        table = self.table
        check_inside(
            fill_linear(
                particles.position,
                particles.first,
                grid.lower,
                grid.window_lower,
                grid.window_shape,
                grid.offset,
                table.nodes,
                table.weight,
                table.gradient,
                grid.spacing,
            )
        )
        return table
