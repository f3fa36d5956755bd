"""CPDI: convected particle domains, parallelograms that follow F (Sadeghirad, Brannon & Burghardt 2011).

A domain that plastic flow makes degenerate is replaced by a rectangle (:mod:`._degenerate_domains`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.api.types import FloatArray, Grid, IntArray, Particles, Setup, Stencil, hookimpl
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.arithmetic import invert
from mpmfw.kernels.stencil import CORNERS, FULL, OUTSIDE, fill_domain, read_window
from mpmfw.kernels.types import Floats, Indices, Ints
from mpmfw_shape._degenerate_domains import is_degenerate, make_rectangle
from mpmfw_shape._tables import PackedRows

if TYPE_CHECKING:
    from mpmfw_shape._rectangles import Rectangles


@device
def deformed_edges(f: Floats, start: Floats, r: Floats, spacing: tuple[float, ...]) -> None:
    """Write R = F R_0 [m] to ``r``; a degenerate domain becomes a rectangle (:mod:`._degenerate_domains`)."""
    dim = len(spacing)
    for d in range(dim):
        for e in range(dim):
            r[d, e] = 0.0
            for a in range(dim):
                r[d, e] += f[d, a] * start[a, e]
    if is_degenerate(r, start, spacing):
        make_rectangle(r, start, spacing)


@kernel
def reach_of_domains(
    deformation_gradient: Floats, half_edges: Floats, reach: Floats, spacing: tuple[float, ...]
) -> None:
    """Write the extent of every domain along every axis, Σ_a |R_da| [m], to ``reach`` (n, dim)."""
    dim = len(spacing)
    r = scratch.matrix(spacing, spacing)
    for p in range(len(reach)):
        deformed_edges(deformation_gradient[p], half_edges[p], r, spacing)
        for d in range(dim):
            reach[p, d] = 0.0
            for e in range(dim):
                reach[p, d] += abs(r[d, e])


@kernel
def fill_cpdi(
    first: Ints,
    position: Floats,
    deformation_gradient: Floats,
    half_edges: Floats,
    lower: Floats,
    window_lower: Ints,
    window_shape: Ints,
    offset: Ints,
    k: int,
    row: Ints,
    nodes: Indices,
    weight: Floats,
    gradient: Floats,
    spacing: tuple[float, ...],
) -> int:
    """CPDI functions; up to 4**dim entries each, about 5 in 2D and 16 in 3D
    (:func:`mpmfw.kernels.fill_domain`).

    The domain is x_p + R ξ, ξ in [−1, 1]^dim, R = F R_0 (:func:`deformed_edges`). With the corners x_c at
    signs s_c, φ_i = 2^−dim Σ_c N_i(x_c) and ∇φ_i = 2^−dim Σ_c R^−T s_c N_i(x_c): mean and mean gradient over
    the domain of the function that interpolates N_i linearly between the corners. Return the first point
    outside its window, −1, or −2 if the table is too short.
    """
    dim = len(spacing)
    n_corners = (
        1 << dim
    )  # not 2**dim, whose value the compiler finds too late to unroll the loops over corners
    share_of_each = 1.0 / n_corners
    inverse_h = 1.0 / spacing[0]
    origin = scratch.vector(spacing)
    shape = scratch.integers(spacing)
    r = scratch.matrix(spacing, spacing)
    inverse = scratch.matrix(spacing, spacing)
    centre = scratch.vector(spacing)
    corner = scratch.matrix(CORNERS, spacing)
    slope = scratch.matrix(CORNERS, spacing)
    share = scratch.vector(CORNERS)
    for c in range(n_corners):
        share[c] = share_of_each
    for f in range(len(first) - 1):
        read_window(lower, window_lower, window_shape, f, origin, shape, spacing)
        start = offset[f]
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                centre[d] = (position[p, d] - origin[d]) * inverse_h
            deformed_edges(deformation_gradient[p], half_edges[p], r, spacing)
            invert(r, inverse, spacing)
            for c in range(n_corners):
                for d in range(dim):
                    corner[c, d] = centre[d]
                    slope[c, d] = 0.0
                    for e in range(dim):
                        sign = 1.0 if (c >> e) & 1 else -1.0
                        corner[c, d] += sign * r[d, e] * inverse_h
                        slope[c, d] += sign * share_of_each * inverse[e, d]
            k = fill_domain(k, corner, share, slope, shape, start, nodes, weight, gradient, spacing)
            if k < 0:
                return p if k == OUTSIDE else FULL
            row[p + 1] = k
    return -1


class Cpdi(PackedRows):
    """φ_ip from the corners of the deformed parallelogram F R_0: up to 16 entries in 2D, 64 in 3D."""

    name = "cpdi"
    fill = fill_cpdi

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Take the domains at the start; the deformed ones follow from F and are not stored."""
        super().setup(setup)
        self.half_edges = setup.half_edges
        self.rectangles: Rectangles | None = None
        if setup.dim == 3 and setup.state.surface is not None:
            from mpmfw_shape._rectangles import Rectangles

            found = Rectangles(setup.state.surface, setup.state.particles, setup.half_edges)
            self.rectangles = found if len(found.corners) else None

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:
        """Return the extent of the deformed domains along every axis [m], (n, dim)."""
        reach = np.empty_like(particles.position)
        spacing = (0.0,) * particles.dim
        reach_of_domains(particles.deformation_gradient, self.half_edges, reach, spacing)
        return reach

    def domains(self, particles: Particles) -> tuple[FloatArray, ...]:
        """Centres, F, and the half-edges at the start."""
        return particles.position, particles.deformation_gradient, self.half_edges

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        """N_i(x_s); at the centre of a rectangle that is cut in four triangles the mean of its corners'
        (:mod:`._rectangles`)."""
        plain = super().interpolate_surface(position=position, first=first, grid=grid)
        if self.rectangles is None or len(position) != len(self.rectangles.index):
            return plain
        return self.rectangles.table_of(plain, len(grid.mass))
