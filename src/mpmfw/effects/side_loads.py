"""Pressure and traction on the sides of a body, constant or changing in time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmfw.effects.faces import FLAT, face_of, sides_of
from mpmfw.effects.time_table import TimeTable
from mpmfw.errors import SceneError
from mpmfw.fields import FloatArray, IntArray
from mpmfw.hookspecs import hookimpl
from mpmfw.kernels import kernel, scratch
from mpmfw.kernels.facets import area_vector, read_corners
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw.state import Grid, State

if TYPE_CHECKING:
    from mpmfw.build import Build
    from mpmfw.scene.tables import Side


@kernel
def add_traction(
    pressure: Float,
    traction: Floats,
    loaded: Ints,
    facets: Ints,
    position: Floats,
    row: Ints,
    nodes: Indices,
    weight: Floats,
    node_force: Floats,
    spacing: tuple[float, ...],
) -> None:
    """f_i += (t − p n) A / dim N_i(x_s) from every corner of every loaded facet, n its outward normal, A its measure."""
    dim = len(spacing)
    corners, force = scratch.matrix(spacing, spacing), scratch.vector(spacing)
    corner = 0.5 if dim == 2 else 1.0 / 6.0  # the area vector of a triangle is twice its area
    share = -pressure / 2.0 if dim == 2 else -pressure / 6.0
    for m in loaded:
        read_corners(m, position, facets, corners, spacing)
        area_vector(corners, force, spacing)
        square = 0.0
        for d in range(dim):
            square += force[d] * force[d]
        area = corner * math.sqrt(square)
        for d in range(dim):
            force[d] = share * force[d] + area * traction[d]
        for a in range(dim):
            node = facets[m, a]
            for k in range(row[node], row[node + 1]):
                for d in range(dim):
                    node_force[nodes[k], d] += weight[k] * force[d]


@dataclass(frozen=True)
class SideLoad:
    """What acts on one side.

    Attributes
    ----------
    facets
        That lie on the side at the start.
    pressure
        p(t) (1,) [Pa].
    traction
        t(t) (dim,) [Pa], of the present area.
    """

    facets: IntArray
    pressure: TimeTable
    traction: TimeTable


class SideLoads:
    """Traction t − p n on the facets that lie on a side of the body at the start."""

    name = "side_loads"
    ledger_term = ("external", "loads on sides")

    def __init__(self, loads: tuple[SideLoad, ...]) -> None:
        self.loads = loads

    @hookimpl
    def add_nodal_force(self, grid: Grid, state: State) -> None:
        """Map the traction with the surface nodes' shape functions, as contact forces are (eq. 11 of
        [H17])."""
        surface = state.surface
        if surface is None or surface.stencil is None:
            raise RuntimeError("loads on sides need tracked surfaces")
        phi = surface.stencil
        for load in self.loads:
            add_traction(
                float(load.pressure.at(state.time)[0]), load.traction.at(state.time), load.facets, surface.facets,
                surface.position, phi.row, phi.nodes, phi.weight, grid.force, state.grid.spacing,
            )  # fmt: skip


def facets_on_side(
    position: FloatArray, facets: IntArray, own: slice, normal: FloatArray, place: float, tolerance: float
) -> IntArray:
    """Facets of one body, ``own``, all of whose corners lie on the side n·x = ``place``."""
    on_side = np.abs(position @ normal - place) <= tolerance
    return np.asarray(own.start + np.flatnonzero(on_side[facets[own]].all(axis=1)), dtype=np.int64)


def planned(made: Build) -> SideLoads:
    """The loaded sides of all bodies.

    Raises
    ------
    SceneError
        No facet lies on one of them.
    """
    surface = made.state.surface
    if surface is None:
        raise RuntimeError("loads on sides need tracked surfaces")
    loads = []
    for body, side in sides_of(made, loaded=True):
        normal, place = face_of(made, body, side)
        tolerance = FLAT * made.state.grid.cell_size
        own = surface.facets_of(body.index)
        loaded = facets_on_side(surface.position, surface.facets, own, normal, place, tolerance)
        if len(loaded) == 0:
            raise SceneError(f"bodies.{body.name}.sides: no surface facet lies on the side '{side.side}'")
        loads.append(SideLoad(loaded, *_in_time(side, made.scene.dim)))
    return SideLoads(tuple(loads))


def _in_time(side: Side, dim: int) -> tuple[TimeTable, TimeTable]:
    """Pressure and traction of a side in time, one of them zero."""
    pressure, traction = TimeTable.constant([0.0]), TimeTable.constant([0.0] * dim)
    if side.pressure is not None:
        given = side.pressure
        pressure = TimeTable(given) if isinstance(given, tuple) else TimeTable.constant([given])
    if side.traction is not None:
        vector: Any = side.traction
        traction = TimeTable(vector) if isinstance(vector[0], tuple) else TimeTable.constant(vector)
    return pressure, traction
