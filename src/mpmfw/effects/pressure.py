"""Pressure on a side of a body, following its surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmfw.effects.faces import FLAT, face_of, sides_of
from mpmfw.errors import SceneError
from mpmfw.fields import FloatArray, IntArray
from mpmfw.hookspecs import hookimpl
from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.facets import area_vector, read_corners
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw.state import Grid, State

if TYPE_CHECKING:
    from mpmfw.build import Build


@kernel
def add_pressure(
    pressure: Float,
    loaded: Ints,
    facets: Ints,
    position: Floats,
    row: Ints,
    nodes: Indices,
    weight: Floats,
    node_force: Floats,
    spacing: tuple[float, ...],
) -> None:
    """f_i −= p n A / dim N_i(x_s) from every corner of every loaded facet, n its outward normal and A its length or area."""
    dim = len(spacing)
    corners, force = scratch.matrix(spacing, spacing), scratch.vector(spacing)
    share = (
        -pressure / 2.0 if dim == 2 else -pressure / 6.0
    )  # the area vector of a triangle is twice its area
    for m in loaded:
        read_corners(m, position, facets, corners, spacing)
        area_vector(corners, force, spacing)
        for d in range(dim):
            force[d] *= share
        for a in range(dim):
            node = facets[m, a]
            for k in range(row[node], row[node + 1]):
                for d in range(dim):
                    node_force[nodes[k], d] += weight[k] * force[d]


class Pressure:
    """Normal traction −p n on the facets that lie on a side of the body at the start."""

    name = "pressure"
    ledger_term = ("external", "pressures")

    def __init__(self, loads: tuple[tuple[float, IntArray], ...]) -> None:
        self.loads = loads

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State) -> None:
        """Map the traction with the surface nodes' shape functions, as contact forces are (eq. 11 of
        [H17])."""
        surface = state.surface
        if surface is None or surface.stencil is None:
            raise RuntimeError("pressure needs tracked surfaces")
        phi = surface.stencil
        for pressure, loaded in self.loads:
            add_pressure(
                pressure, loaded, surface.facets, surface.position, phi.row, phi.nodes, phi.weight, grid.force,
                state.grid.spacing,
            )  # fmt: skip


def facets_on_side(
    position: FloatArray, facets: IntArray, own: slice, normal: FloatArray, place: float, tolerance: float
) -> IntArray:
    """Facets of one body, ``own``, all of whose corners lie on the side n·x = ``place``."""
    on_side = np.abs(position @ normal - place) <= tolerance
    return np.asarray(own.start + np.flatnonzero(on_side[facets[own]].all(axis=1)), dtype=np.int64)


def planned(made: Build) -> Pressure:
    """The sides under pressure of all bodies.

    Raises
    ------
    SceneError
        No facet lies on one of them.
    """
    surface = made.state.surface
    if surface is None:
        raise RuntimeError("pressure needs tracked surfaces")
    loads = []
    for body, side in sides_of(made, pressed=True):
        normal, place = face_of(made, body, side)
        tolerance = FLAT * made.state.grid.cell_size
        own = surface.facets_of(body.index)
        loaded = facets_on_side(surface.position, surface.facets, own, normal, place, tolerance)
        if len(loaded) == 0:
            raise SceneError(f"bodies.{body.name}.sides: no surface facet lies on the side '{side.side}'")
        loads.append((float(side.pressure or 0.0), loaded))
    return Pressure(tuple(loads))
