"""Tables of GIMP, CPDI and CPDI2: rows of varying length, lengthened where they do not fit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from mpmfw.api.shape import check_inside, empty_stencil
from mpmfw.api.types import Grid, Particles, Setup, Stencil, hookimpl
from mpmfw.kernels import FULL
from mpmfw_shape._at_points import LinearSurface

#: Entries a point to begin with: a domain of half a cell has 6.25 (2D) or 15.6 (3D) nodes in its box on
#: average.
ENTRIES = {2: 7, 3: 18}


class PackedRows(LinearSurface):
    """Base of shape functions of points with a domain; the boundary's basis is linear."""

    #: A kernel, called as ``fill(first, *domains, *windows, k, row, nodes, weight, gradient, spacing)``: it
    #: fills rows from entry k on, and returns the first point outside its window, −1, or ``FULL``.
    fill: ClassVar[Callable[..., int]]

    def domains(self, particles: Particles) -> tuple[Any, ...]:
        """Arrays of the points' domains, as the kernel takes them."""
        raise NotImplementedError

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Make a table with room for the usual number of entries, and for one whole row of 4**dim."""
        points, dim = setup.state.particles.count, setup.dim
        self.room = _with_room(points, points * ENTRIES[dim] + 4**dim, dim)

    @hookimpl
    def interpolate(self, particles: Particles, grid: Grid) -> Stencil:
        """φ_ip and ∇φ_ip of the domains; the room is lengthened if it is too short."""
        threads, first = particles.threads, particles.first
        where = (*self.domains(particles), *grid.windows)

        def fill(first: Any, *table: Any) -> int:
            return type(self).fill(first, *where, *table, grid.spacing)

        while True:
            room = self.room.room
            code = fill(first, 0, *room) if threads is None else threads.fill_rows(fill, first, room)
            if code != FULL:
                break
            self.room = _with_room(particles.count, 3 * len(room[1]) // 2, grid.dim)
        check_inside(code)
        return self.room.show(self.room.row[-1])


def _with_room(points: int, entries: int, dim: int) -> Stencil:
    room = empty_stencil(1, entries, dim)
    room.row = empty_stencil(points, 0, dim).row
    return room
