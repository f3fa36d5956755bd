"""uGIMP: generalised interpolation with undeformed square particles (Bardenhagen & Kober 2004)."""

from __future__ import annotations

import numpy as np

from mpmfw.api.types import (
    Field,
    FloatArray,
    Grid,
    IntArray,
    Particles,
    SceneError,
    Setup,
    Stencil,
    hookimpl,
)
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.lanes import floor, positive
from mpmfw.kernels.products import NODES, WIDTH, fill_factors
from mpmfw.kernels.stencil import fill_tensor_product, fits, read_window
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Table
from mpmfw_shape._tables import BEYOND_AXIS, FromProducts

#: Courant number that no arrangement of points of half a cell needs to fear: a point alone has at most the
#: frequency ω² = c² (1 + ν/(1−ν)) Σ_i (∂φ_i)²/φ_i, where the sum is up to 9.33/h², and an assembly has none
#: above its parts'. That is 0.655 √(1 − ν): 0.55 for ν = 0.3, where turned blocks diverge at 0.58, and 0.5
#: for ν = 0.41.
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
    base[d] = floor(xi - l)
    u = xi - l - base[d]
    b = positive(u + 2.0 * l - 1.0)
    a = 2.0 * l - b
    share = 0.5 / l
    rise = a * (u + 0.5 * a)
    weight[d, 0] = (a - rise) * share
    weight[d, 1] = (rise + b - 0.5 * b * b) * share
    weight[d, 2] = 0.5 * b * b * share
    slope[d, 0] = -a * share * inverse_h
    slope[d, 1] = (a - b) * share * inverse_h
    slope[d, 2] = b * share * inverse_h


@device
def weigh_with_radius(
    xi: Float, l: Float, radius: Float, base: Floats, weight: Floats, slope: Floats
) -> None:
    """Weigh the slopes along x with r: ∫ r ∂N_i / ∫ r = ∂S_i + ((N_i(ξ − l) + N_i(ξ + l)) / 2 − S_i) / r.

    That is [r N_i] − ∫ N_i over 2 l r, by parts; ``radius`` r [m], ξ and l in cells.
    """
    for a in range(WIDTH):
        low = max(1.0 - abs(xi - l - base[0] - a), 0.0)
        high = max(1.0 - abs(xi + l - base[0] - a), 0.0)
        slope[0, a] += (0.5 * (low + high) - weight[0, a]) / radius


@kernel
def fill_gimp(
    position: Floats, first: Ints, half_length: Floats, radius: Floats, grid: Nodes, table: Table,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """uGIMP functions of square particles of bodies of revolution, 3**dim entries each. Return the first
    point outside its window, or −1."""
    dim, inverse_h = len(spacing), 1.0 / spacing[0]
    origin, shape, base = scratch.vector(spacing), scratch.integers(spacing), scratch.vector(spacing)
    w, s = scratch.matrix(spacing, NODES), scratch.matrix(spacing, NODES)
    for f in range(len(first) - 1):
        read_window(grid, f, origin, shape, spacing)
        for p in range(first[f], first[f + 1]):
            for d in range(dim):
                xi = (position[p, d] - origin[d]) * inverse_h
                gimp_weights(xi, half_length[p] * inverse_h, inverse_h, d, base, w, s)
            xi, l = (position[p, 0] - origin[0]) * inverse_h, half_length[p] * inverse_h
            if half_length[p] > radius[p] * BEYOND_AXIS:
                l = radius[p] * BEYOND_AXIS * inverse_h
                gimp_weights(xi, l, inverse_h, 0, base, w, s)
            weigh_with_radius(xi, l, radius[p], base, w, s)
            if not fits(base, WIDTH, shape, spacing):
                return p
            fill_tensor_product(p * WIDTH**dim, WIDTH, base, w, s, shape, grid.offset[f], table, spacing)
    return -1


@kernel
def fill_gimp_factors(
    position: Floats, first: Ints, half_length: Floats, grid: Nodes, factors: Table,
    spacing: tuple[float, ...],
) -> int:  # fmt: skip
    """As :func:`fill_gimp`, the factors of the products, without a weight of the radius."""
    return fill_factors(gimp_weights, position, first, half_length, grid, factors, spacing)


class Gimp(FromProducts):
    """φ_ip averages N_i over the particle's undeformed square: up to 9 nodes in 2D, 27 in 3D."""

    name = "gimp"
    massless_boundary = True
    axisymmetric = True
    courant = COURANT

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [HALF_LENGTH]

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Take l_p from the volumes; particles larger than a cell are refused."""
        super().setup(setup)
        self.half_length = setup.allocate(self.name, HALF_LENGTH)
        self.half_length[:] = 0.5 * setup.state.particles.initial_volume ** (1.0 / setup.dim)
        if self.half_length.max() > 0.5 * setup.cell_size * (1.0 + 1e-9):
            raise SceneError(
                f"'gimp' has a particle of edge {2 * self.half_length.max():.4g} m, larger than the cell "
                f"({setup.cell_size:.4g} m); expected bodies.*.particles.size <= grid.cell_size",
                key="shape.method",
            )

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:
        return np.repeat(self.half_length[:, None], particles.dim, axis=1)

    def fill_rows(self, position: FloatArray, first: IntArray, grid: Grid, table: Stencil) -> int:
        """Fill the points' ``table``, or its factors, or the surface's."""
        if table is self._surface:
            return super().fill_rows(position, first, grid, table)
        points = position, first, self.half_length
        if table.factors is not None:
            return int(fill_gimp_factors(*points, grid, table.factors, grid.spacing))
        return int(fill_gimp(*points, np.ascontiguousarray(position[:, 0]), grid, table, grid.spacing))
