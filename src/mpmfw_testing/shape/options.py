"""No option without effect."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Iterator
from typing import Any

import numpy as np

from mpmfw.state.structs import OutsideGrid, Stencil
from mpmfw_testing.options import every_option_acts
from mpmfw_testing.shape.cases import CELLS, MIDDLE, dimensions_of, two_points, velocity_gradient
from mpmfw_testing.shape.placement import Placement
from mpmfw_testing.subject import Subject

#: Places of the point [cells along every axis]: in the middle, on a face, in the grid's first and last cell.
PLACES = (MIDDLE + 0.3, float(MIDDLE), 0.4, CELLS - 0.4)


def options(subject: Subject) -> None:
    """Every option changes something or is refused. Every option changes a table by a bit at least, for one
    of its values.

    Tables of points and, in 2D, of surface points, in the middle and at the ends of the grid, before and
    after a deformation. Values are tried alone and together with each choice of the other options. Values may
    be refused, by the model or as a ``SceneError``, but not all that are tried.
    """
    every_option_acts(subject, [functools.partial(_digest, subject)])


def _digest(subject: Subject, options: dict[str, Any]) -> str:
    """Digest of the last bits of all tables."""
    configured = Subject(
        subject.kind, subject.label, subject.plugin, subject.factory, {**subject.options, **options}
    )
    digest = hashlib.sha256()
    for dim in dimensions_of(configured):
        for at in PLACES:
            placed = two_points(configured, np.full(dim, at), 0.5)
            for part in _tables(placed):
                digest.update(part)
    return digest.hexdigest()


def _tables(placed: Placement) -> Iterator[bytes]:
    """The bytes of the tables of one placement, or words where the point is refused."""
    centre = placed.grid.lower + placed.grid.cell_size * MIDDLE
    try:
        yield from _bytes(placed.table())
        if placed.dim == 2:
            yield from _bytes(placed.surface_table(placed.particles.position[1:].copy()))
        placed.deform(velocity_gradient("stretch and rotation", placed.dim), centre)
        yield from _bytes(placed.table())
    except OutsideGrid as error:
        yield f"outside: {error.index}".encode()


def _bytes(table: Stencil) -> Iterator[bytes]:
    for array in table.members().values():
        yield np.ascontiguousarray(array).tobytes()


#: In the order in which they are run.
CHECKS = (options,)
