"""Tables of GIMP, CPDI and CPDI2: rows of varying length, lengthened where they do not fit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmfw.api.shape import check_inside, empty_stencil
from mpmfw.api.types import Particles, Stencil
from mpmfw.kernels import FULL

#: Entries a point to begin with: a domain of half a cell has 6.25 (2D) or 15.6 (3D) nodes in its box on average.
ENTRIES = {2: 7, 3: 18}


def empty_rows(points: int, dim: int) -> Stencil:
    """A table with room for the usual number of entries, and for one whole row of 4**dim."""
    return _with_room(points, points * ENTRIES[dim] + 4**dim, dim)


def _with_room(points: int, entries: int, dim: int) -> Stencil:
    room = empty_stencil(1, entries, dim)
    room.row = empty_stencil(points, 0, dim).row
    return room


def fill_rows(
    fill: Callable[..., int], room: Stencil, particles: Particles, where: tuple[Any, ...], spacing: tuple[float, ...]
) -> Stencil:  # fmt: skip
    """Fill ``room`` by ``fill(first, *where, 0, *room, spacing)``, from entry 0 on, or a longer one if it is too short.

    Returns
    -------
    The table, to be used again.

    Raises
    ------
    OutsideGrid
        A point is outside its window.
    """
    threads, first = particles.threads, particles.first
    while True:
        if threads is None:
            code = fill(first, *where, 0, *room.room, spacing)
        else:
            code = threads.fill_rows(lambda own, *table: fill(own, *where, *table, spacing), first, room.room)
        if code != FULL:
            break
        room = _with_room(len(room.row) - 1, 3 * len(room.room[1]) // 2, len(spacing))
    check_inside(code)
    return room.show(room.row[-1])
