"""Tables of shape functions: of points without extent, and of points with a domain.

Surfaces have the same functions as points without extent, and plain linear ones with GIMP and CPDI.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from mpmfw.api.shape import ShapeFunction, check_inside, empty_stencil
from mpmfw.api.types import FloatArray, Grid, IntArray, Particles, Products, Setup, Stencil, hookimpl
from mpmfw.kernels import FULL, device
from mpmfw.kernels.products import WIDTH
from mpmfw.kernels.stencil import fill_linear
from mpmfw.kernels.types import Floats


class LinearSurface(ShapeFunction):
    """Mix-in of ``interpolate_surface`` with linear functions, the trace of Σ V ∇S = ∮ N n dS for CPDI."""

    rows_ascend = True
    #: A kernel that fills the surface's table, and the number of its functions along an axis.
    functions: ClassVar[tuple[Callable[..., int], int]] = (fill_linear, 2)
    _surface: Stencil | None = None

    def entries(self, dim: int) -> int:
        """Number of nodes that the functions of a point on the surface touch."""
        return int(self.functions[1] ** dim)

    @property
    def choices(self) -> tuple[Any, ...]:
        """Further arguments of the kernel."""
        return ()

    def fill_rows(self, position: FloatArray, first: IntArray, grid: Grid, table: Stencil) -> int:
        """Fill a ``table`` as :meth:`fill_at`; return the first point outside its window, or −1."""
        return int(self.functions[0](position, first, grid, table, grid.spacing, *self.choices))

    def fill_at(
        self, position: FloatArray, first: IntArray, grid: Grid, table: Stencil, threads: Any = None
    ) -> Stencil:
        """Fill a ``table`` by the functions at points of ``position`` (n, dim) [m].

        Those of field f are ``first[f]:first[f + 1]``. Raise OutsideGrid for a point outside its window.
        """
        if threads is None:
            check_inside(self.fill_rows(position, first, grid, table))
        else:
            firsts = threads.firsts(first)
            for code in threads.each(lambda t: self.fill_rows(position, firsts[t], grid, table)):
                check_inside(code)
        return table

    @hookimpl
    def interpolate_surface(self, position: FloatArray, first: IntArray, grid: Grid) -> Stencil:
        if self._surface is None:
            self._surface = empty_stencil(len(position), self.entries(grid.dim), grid.dim, gradient=False)
        return self.fill_at(position, first, grid, self._surface)


@device
def fold_at_start(d: int, values: Floats, width: int) -> None:
    """Give the share of the node before the grid's first to nodes 0 and 1 of the ``width`` nodes of a spline.

    The missing node is read by linear extrapolation, u_{−1} = 2 u_0 − u_1. This makes Steffen's modified
    splines, of cubic ones ξ³/6 − ξ + 1 for the first node. They keep Σ φ = 1 and Σ φ x = x, are nowhere
    negative, and the first node alone is felt at the grid's end. The freed last entry becomes zero.
    """
    ghost = values[d, 0]
    values[d, 0] = values[d, 1] + 2.0 * ghost
    values[d, 1] = values[d, 2] - ghost
    for a in range(2, width - 1):
        values[d, a] = values[d, a + 1]
    values[d, width - 1] = 0.0


class AtPoints(LinearSurface):
    """Base of shape functions of points without extent: surfaces are mapped with the same ``functions``."""

    #: Whether the length of rows is compiled in, which is faster, but compiles kernels for each length.
    compiles_length: ClassVar[bool] = False

    @hookimpl
    def setup(self, setup: Setup) -> None:
        points, dim = setup.state.particles.count, setup.dim
        self.table = empty_stencil(points, self.entries(dim), dim, uniform=self.compiles_length)

    @hookimpl
    def particle_reach(self, particles: Particles) -> FloatArray:
        """Points have no extent; the window's margin holds the support."""
        return np.zeros_like(particles.position)

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        return self.fill_at(particles.position, particles.first, grid, self.table, particles.threads)


class FromProducts(AtPoints):
    """Base of products of three functions of one axis: the step takes its sums from the factors."""

    @hookimpl
    def setup(self, setup: Setup) -> None:
        points, dim = setup.state.particles.count, setup.dim
        if setup.state.grid.axisymmetric:  # the table is read in every step
            self.table = empty_stencil(points, WIDTH**dim, dim)
        else:
            self.table = Products(points, dim)

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        table = super().interpolate(particles, grid)
        return table.renew() if isinstance(table, Products) else table


#: Largest reach of a domain towards the axis, over its radius: what is beyond is cut on both sides.
BEYOND_AXIS = 1.0 - 1e-12

#: Entries a point to begin with: a domain of half a cell has 6.25 (2D) or 15.6 (3D) nodes in its box on
#: average.
ENTRIES = {2: 7, 3: 18}


class PackedRows(LinearSurface):
    """Base of shape functions of points with a domain; the boundary's basis is linear."""

    #: A kernel, called as ``fill(first, *domains, grid, k, end, table, spacing)``: it fills rows with the
    #: entries k to ``end``, and returns the first point outside its window, −1, or ``FULL``. Of bodies of
    #: revolution it has the radii (n,) [m] as well, which gradients are weighted with.
    fill: ClassVar[Callable[..., int]]

    def domains(self, particles: Particles) -> tuple[Any, ...]:
        """Arrays of the points' domains, as the kernel takes them."""
        raise NotImplementedError

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Make a table with room for the usual number of entries, and for one whole row of 4**dim."""
        points, dim = setup.state.particles.count, setup.dim
        self.table = _with_room(points, points * ENTRIES[dim] + 4**dim, dim)

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """φ_ip and ∇φ_ip of the domains; a table that is too short is replaced by a longer one."""
        threads, first, domains = particles.threads, particles.first, self.domains(particles)
        radii = (np.ascontiguousarray(particles.position[:, 0]),) if grid.axisymmetric else ()

        def fill(first: IntArray, k: int, end: int) -> int:
            return type(self).fill(first, *domains, grid, k, end, self.table, grid.spacing, *radii)

        code = FULL
        while code == FULL:
            room = self.table.room
            code = fill(first, 0, room) if threads is None else threads.fill_rows(fill, first, self.table)
            if code == FULL:
                self.table = _with_room(particles.count, 3 * room // 2, grid.dim)
        check_inside(code)
        return shown(self.table)


def shown(table: Stencil) -> Stencil:
    """Show the entries of the rows alone in Python; kernels see all of the room."""
    row, nodes, weight, gradient = table.kernel_arrays
    vars(table).update(nodes=nodes[: row[-1]], weight=weight[: row[-1]], gradient=gradient[: row[-1]])
    return table


def _with_room(points: int, entries: int, dim: int) -> Stencil:
    return Stencil(
        row=np.zeros(points + 1, dtype=np.int64),
        nodes=np.zeros(entries, dtype=np.int32),
        weight=np.zeros(entries),
        gradient=np.zeros((entries, dim)),
    )
