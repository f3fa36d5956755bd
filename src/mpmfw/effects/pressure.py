"""Pressure on a side of a body, following its surface (2D)."""

from __future__ import annotations

import numpy as np

from mpmfw.fields import FloatArray, IntArray
from mpmfw.hookspecs import hookimpl
from mpmfw.kernels import kernel
from mpmfw.kernels.types import Float, Floats, Indices, Ints
from mpmfw.state import Grid, State


@kernel
def add_pressure(
    pressure: Float,
    segments: Ints,
    following: Ints,
    position: Floats,
    row: Ints,
    nodes: Indices,
    weight: Floats,
    node_force: Floats,
) -> None:
    """f_i −= p n l / 2 N_i(x_s) from both ends of every loaded segment; n = (t_y, −t_x) / l is the outward
    normal."""
    for s in range(len(segments)):
        a = segments[s]
        b = following[a]
        force_x = -0.5 * pressure * (position[b, 1] - position[a, 1])
        force_y = 0.5 * pressure * (position[b, 0] - position[a, 0])
        for end in (a, b):
            for k in range(row[end], row[end + 1]):
                node_force[nodes[k], 0] += weight[k] * force_x
                node_force[nodes[k], 1] += weight[k] * force_y


class Pressure:
    """Normal traction −p n on the segments that lie on a side of the body at the start."""

    name = "pressure"

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
        for pressure, segments in self.loads:
            add_pressure(
                pressure, segments, surface.next, surface.position, phi.row, phi.nodes, phi.weight, grid.force
            )


def segments_on_side(
    position: FloatArray, following: IntArray, own: slice, normal: FloatArray, place: float, tolerance: float
) -> IntArray:
    """Segments of one body both of whose ends lie on the side n·x = ``place``, as indices of their first node."""
    index = np.arange(own.start, own.stop)
    on_side = np.abs(position @ normal - place) <= tolerance
    return np.asarray(index[on_side[index] & on_side[following[index]]], dtype=np.int64)
