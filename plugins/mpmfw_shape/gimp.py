"""uGIMP: generalised interpolation with undeformed square particles (Bardenhagen & Kober 2004)."""

from __future__ import annotations

import math

import numpy as np

from mpmfw.api import (
    Field,
    FloatArray,
    Grid,
    Particles,
    SceneError,
    Setup,
    Stencil,
    check_inside,
    empty_stencil,
    hookimpl,
)
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.stencil import fill_tensor_product, fits, read_window
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw_shape._bilinear_surface import LinearSurface

WIDTH = 3

#: Courant number that no arrangement of points of half a cell needs to fear: a point alone has at most the frequency
#: ω² = c² (1 + ν/(1−ν)) Σ_i (∂φ_i)²/φ_i, where the sum is up to 9.33/h², and an assembly has none above its parts'. That is
#: 0.655 √(1 − ν): 0.55 for ν = 0.3, where turned blocks diverge at 0.58, and 0.5 for ν = 0.41.
COURANT = 0.5
HALF_LENGTH = Field(
    "half_length", ("particle",), "m", "half the edge of the particle's square domain, l_p = V_p0^(1/dim) / 2"
)


@device
def gimp_weights(
    xi: Float, l: Float, inverse_h: Float, d: int, base: Floats, weight: Floats, slope: Floats
) -> None:
    """The three functions S_i(ξ) = 1/(2 l) ∫ N_i over [ξ − l, ξ + l], all lengths in cells, l ≤ 1/2.

    The domain begins at u in the cell of the first node, covers a length a of it and reaches a length b into
    the next cell; a + b = 2 l. The integrals of the two hat functions over either part need no case
    distinction.
    """
    base[d] = math.floor(xi - l)
    u = xi - l - base[d]
    b = max(u + 2.0 * l - 1.0, 0.0)
    a = 2.0 * l - b
    share = 0.5 / l
    rise = a * (u + 0.5 * a)
    weight[d, 0] = (a - rise) * share
    weight[d, 1] = (rise + b - 0.5 * b * b) * share
    weight[d, 2] = 0.5 * b * b * share
    slope[d, 0] = -a * share * inverse_h
    slope[d, 1] = (a - b) * share * inverse_h
    slope[d, 2] = b * share * inverse_h


@kernel
def fill_gimp(
    position: Floats,
    half_length: Floats,
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
    """uGIMP functions of square particles; 3**dim entries each. Return the first point outside its window, or
    −1."""
    dim = len(spacing)
    inverse_h = 1.0 / spacing[0]
    origin = scratch.vector(spacing)
    shape = scratch.integers(spacing)
    base = scratch.vector(spacing)
    w = scratch.matrix(spacing, (0.0, 0.0, 0.0))
    s = scratch.matrix(spacing, (0.0, 0.0, 0.0))
    for f in range(len(first) - 1):
        read_window(lower, window_lower, window_shape, f, origin, shape, spacing)
        start = offset[f]
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                xi = (position[p, d] - origin[d]) * inverse_h
                gimp_weights(xi, half_length[p] * inverse_h, inverse_h, d, base, w, s)
            if not fits(base, WIDTH, shape, spacing):
                return p
            fill_tensor_product(
                p * WIDTH**dim, WIDTH, base, w, s, shape, start, nodes, weight, gradient, spacing
            )
    return -1


class Gimp(LinearSurface):
    """φ_ip averages N_i over the particle's undeformed square: 9 nodes in 2D, 27 in 3D."""

    name = "gimp"
    massless_boundary = True
    courant = COURANT

    @hookimpl
    def declare_fields(self) -> list[Field]:
        """The particles' half-lengths."""
        return [HALF_LENGTH]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Take l_p from the volumes; particles larger than a cell are refused."""
        particles = setup.state.particles
        self.half_length = setup.allocate(self.name, HALF_LENGTH)
        self.half_length[:] = 0.5 * particles.initial_volume ** (1.0 / setup.dim)
        if self.half_length.max() > 0.5 * setup.cell_size * (1.0 + 1e-9):
            raise SceneError(
                f"shape 'gimp': a particle of edge {2 * self.half_length.max():.4g} m is larger than the "
                f"cell ({setup.cell_size:.4g} m); expected bodies.*.particles.size <= grid.cell_size"
            )
        self.table = empty_stencil(particles.count, WIDTH**setup.dim, setup.dim)

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:
        """l_p along every axis."""
        return np.repeat(self.half_length[:, None], particles.dim, axis=1)

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """S_ip and ∇S_ip."""
        table = self.table
        check_inside(
            fill_gimp(
                particles.position,
                self.half_length,
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
