"""CPDI: convected particle domains, parallelograms that follow F (Sadeghirad, Brannon & Burghardt 2011).

Degenerate domains, as plastic flow makes them, are replaced by rectangles of bounded edges. The mean gradient
over a parallelogram R ξ is R^−T times differences of N_i along its edges. Where these are long and nearly
parallel, the gradient exceeds 1/h without a bound. A very thin domain has, where it is alone, a node with
nearly no mass but a force. In both cases steps that are stable for the bulk diverge, and points invert. The
rectangle has the principal axes of the ellipse R Rᵀ, and the point's centre and volume: sums of φ, ∇φ and x φ
are exact for any domain. Homel, Brannon & Guilkey (2016, doi:10.1002/nme.5151) bound the diagonals alone.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mpmfw.api.types import FloatArray, Grid, IntArray, Particles, Setup, Stencil, hookimpl
from mpmfw.kernels import device, kernel, scratch
from mpmfw.kernels.arithmetic import determinant, invert, multiply
from mpmfw.kernels.stencil import FULL, OUTSIDE, fill_parallelepiped, read_window
from mpmfw.kernels.types import Float, Floats, Ints, Nodes, Table
from mpmfw_shape._tables import BEYOND_AXIS, PackedRows

if TYPE_CHECKING:
    from mpmfw_shape._rectangles import Rectangles


#: An edge that is longer or shorter than at the start by more than this factor makes a domain degenerate.
STRETCH = 4.0

#: Least |det R| over the product of the edges' lengths of a domain that is not degenerate: edges at 30° in
#: 2D.
SQUARENESS = 0.5

#: Largest factor between half an edge of the rectangle and |det R_0|^(1/dim).
KEPT_STRETCH = 2.0

#: Sweeps of Jacobi rotations: the first is exact in 2D, the last changes nothing in 3D.
SWEEPS = 6


@device
def edge_square(r: Floats, e: int, spacing: tuple[float, ...]) -> Float:
    """Return |r_e|² of the half-edge vector r_e, a column of R [m^2]."""
    square = 0.0
    for d in range(len(spacing)):
        square += r[d, e] * r[d, e]
    return square


@device
def is_degenerate(r: Floats, start: Floats, spacing: tuple[float, ...]) -> bool:
    """Return whether the half-edges ``r`` (dim, dim), R, are sheared or stretched too far from ``start``, R_0
    [m]."""
    box = 1.0
    stretched = False
    for e in range(len(spacing)):
        square, before = edge_square(r, e, spacing), edge_square(start, e, spacing)
        box *= square
        stretched = stretched or square > STRETCH**2 * before or before > STRETCH**2 * square
    return stretched or determinant(r, spacing) ** 2 < SQUARENESS**2 * box


@device
def make_rectangle(r: Floats, start: Floats, spacing: tuple[float, ...]) -> None:
    """Write the edges of the rectangle that replaces a degenerate domain to ``r``; ``start`` is R_0 [m].

    One-sided Jacobi rotations (Hestenes 1958) make the columns orthogonal: R J with an orthogonal J.
    """
    dim = len(spacing)
    for _ in range(SWEEPS):
        for a in range(dim - 1):
            for b in range(a + 1, dim):
                product = 0.0
                for d in range(dim):
                    product += r[d, a] * r[d, b]
                if product != 0.0:
                    ratio = (edge_square(r, b, spacing) - edge_square(r, a, spacing)) / (2.0 * product)
                    tangent = math.copysign(1.0, ratio) / (abs(ratio) + math.sqrt(1.0 + ratio * ratio))
                    cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
                    for d in range(dim):
                        first, second = r[d, a], r[d, b]
                        r[d, a] = cosine * (first - tangent * second)
                        r[d, b] = cosine * (tangent * first + second)
    size = abs(determinant(start, spacing)) ** (1.0 / dim)
    for e in range(dim):
        length = math.sqrt(edge_square(r, e, spacing))
        kept = min(max(length, size / KEPT_STRETCH), size * KEPT_STRETCH)
        for d in range(dim):
            r[d, e] *= kept / length


@device
def deformed_edges(f: Floats, start: Floats, r: Floats, spacing: tuple[float, ...]) -> None:
    """Write R = F R_0 [m] to ``r``; a degenerate domain becomes a rectangle (:func:`make_rectangle`)."""
    multiply(f, start, r, spacing)
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


@device
def keep_from_axis(r: Floats, radius: Float, spacing: tuple[float, ...]) -> None:
    """Narrow a domain of half-edges ``r`` [m] that would reach beyond the axis at a distance ``radius``."""
    reach = 0.0
    for e in range(len(spacing)):
        reach += abs(r[0, e])
    if reach > radius * BEYOND_AXIS:
        for e in range(len(spacing)):
            r[0, e] *= radius * BEYOND_AXIS / reach


@kernel
def fill_cpdi(
    first: Ints, position: Floats, deformation_gradient: Floats, half_edges: Floats, grid: Nodes, k: int,
    end: int, table: Table, spacing: tuple[float, ...], radius: Floats | None = None,
) -> int:  # fmt: skip
    """CPDI functions; up to 4**dim entries each, about 5 in 2D and 16 in 3D
    (:func:`mpmfw.kernels.fill_domain`).

    The domain is x_p + R ξ, ξ in [−1, 1]^dim, R = F R_0 (:func:`deformed_edges`). With the corners x_c at
    signs s_c, φ_i = 2^−dim Σ_c N_i(x_c) and ∇φ_i = 2^−dim Σ_c R^−T s_c N_i(x_c): mean and mean gradient over
    the domain of the function that interpolates N_i linearly between the corners. The mean gradient weighted
    with the ``radius`` r (n,) [m] has s_c,e (1 + s_c,a R_ra / (3 r)) instead of s_c,e, a the other edge.
    Return the first point outside its window, −1, or −2 if the table is too short.
    """
    dim, inverse_h = len(spacing), 1.0 / spacing[0]
    origin, shape, centre = scratch.vector(spacing), scratch.integers(spacing), scratch.vector(spacing)
    r, inverse = scratch.matrix(spacing, spacing), scratch.matrix(spacing, spacing)
    edges, weighted = scratch.matrix(spacing, spacing), scratch.vector(spacing)
    for f in range(len(first) - 1):
        read_window(grid, f, origin, shape, spacing)
        for p in range(first[f], first[f + 1]):
            deformed_edges(deformation_gradient[p], half_edges[p], r, spacing)
            if radius is not None:
                keep_from_axis(r, radius[p], spacing)
            invert(r, inverse, spacing)
            for d in range(dim):
                centre[d] = (position[p, d] - origin[d]) * inverse_h
                if radius is not None:
                    weighted[d] = r[0, 1 - d] / (3.0 * radius[p])
                for e in range(dim):
                    edges[d, e] = r[d, e] * inverse_h
            across = None if radius is None else weighted
            k = fill_parallelepiped(
                k, end, centre, edges, inverse, across, shape, grid.offset[f], table, spacing
            )
            if k < 0:
                return p if k == OUTSIDE else FULL
            table.row[p + 1] = k
    return -1


class Cpdi(PackedRows):
    """φ_ip from the corners of the deformed parallelogram F R_0: up to 16 entries in 2D, 64 in 3D."""

    name = "cpdi"
    fill = fill_cpdi
    axisymmetric = True

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
