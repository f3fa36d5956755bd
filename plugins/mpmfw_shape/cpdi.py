"""CPDI: convected particle domains, parallelograms that follow F (Sadeghirad, Brannon & Burghardt 2011)."""

from __future__ import annotations

import numpy as np

from mpmfw.api import FloatArray, Grid, Particles, Setup, Stencil, check_inside, empty_stencil, hookimpl
from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.small_matrix import invert
from mpmfw.kernels.stencil import fill_corner_in_cells, read_window
from mpmfw.kernels.types import Floats, Indices, Ints
from mpmfw_shape._bilinear_surface import LinearSurface


@kernel
def fill_cpdi(
    position: Floats,
    deformation_gradient: Floats,
    half_edges: Floats,
    first: Ints,
    lower: Floats,
    window_lower: Ints,
    window_shape: Ints,
    offset: Ints,
    nodes: Indices,
    weight: Floats,
    gradient: Floats,
    spacing: tuple[float, ...],
) -> int:
    """CPDI functions; 4**dim entries each (2**dim corners, 2**dim nodes round each corner).

    The domain is x_p + R ξ, ξ in [−1, 1]^dim, R = F R_0. With the corners x_c at signs s_c, φ_i = 2^−dim Σ_c
    N_i(x_c) and ∇φ_i = 2^−dim Σ_c R^−T s_c N_i(x_c): mean and mean gradient over the domain of the function
    that interpolates N_i linearly between the corners. Return the first point outside its window, or −1.
    """
    dim = len(spacing)
    n_corners = 2**dim
    share = 1.0 / n_corners
    inverse_h = 1.0 / spacing[0]
    origin = scratch.vector(spacing)
    shape = scratch.integers(spacing)
    r = scratch.matrix(spacing, spacing)
    inverse = scratch.matrix(spacing, spacing)
    slope = scratch.vector(spacing)
    centre = scratch.vector(spacing)
    corner = scratch.vector(spacing)
    for f in range(len(first) - 1):
        read_window(lower, window_lower, window_shape, f, origin, shape, spacing)
        start = offset[f]
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                centre[d] = (position[p, d] - origin[d]) * inverse_h
                for e in range(dim):
                    r[d, e] = 0.0
                    for a in range(dim):
                        r[d, e] += deformation_gradient[p, d, a] * half_edges[p, a, e]
            invert(r, inverse, spacing)
            for c in range(n_corners):
                for d in range(dim):
                    corner[d] = centre[d]
                    slope[d] = 0.0
                    for e in range(dim):
                        sign = 1.0 if (c >> e) & 1 else -1.0
                        corner[d] += sign * r[d, e] * inverse_h
                        slope[d] += sign * share * inverse[e, d]
                k = (p * n_corners + c) * n_corners
                if not fill_corner_in_cells(
                    k, corner, share, slope, shape, start, nodes, weight, gradient, spacing
                ):
                    return p
    return -1


class Cpdi(LinearSurface):
    """φ_ip from the corners of the deformed parallelogram F R_0: 16 entries in 2D, 64 in 3D."""

    name = "cpdi"

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Take the domains at the start; the deformed ones are F R_0 and are not stored."""
        self.half_edges = setup.half_edges
        self.table = empty_stencil(setup.state.particles.count, 4**setup.dim, setup.dim)

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:
        """Extent of the deformed parallelogram along every axis, Σ_a |(F R_0)_da|."""
        reach: FloatArray = np.abs(particles.deformation_gradient @ self.half_edges).sum(axis=2)
        return reach

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """φ_ip and ∇φ_ip of the deformed domains."""
        table = self.table
        check_inside(
            fill_cpdi(
                particles.position,
                particles.deformation_gradient,
                self.half_edges,
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
