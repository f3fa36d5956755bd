"""Fixed sides and sides with prescribed velocity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.fields import FloatArray
from mpmfw.hookspecs import hookimpl
from mpmfw.kernels import kernel
from mpmfw.kernels.types import Floats
from mpmfw.state import Body, Grid


@kernel
def prescribe_side(
    start: int,
    stop: int,
    axis: int,
    sign: float,
    plane: float,
    velocity: Floats,
    node_position: Floats,
    node_mass: Floats,
    node_momentum: Floats,
    spacing: tuple[float, ...],
) -> None:
    """(m v)_i = m_i v on nodes ``start:stop`` that lie on or beyond the plane, sign (x_axis − plane) ≥ −h/2.

    A plane between two nodes is taken to lie on the nearer one: a side that is pulled outwards would lose
    hold of its nodes at once if only those beyond it counted. Components of ``velocity`` that are NaN stay
    free.
    """
    dim = len(spacing)
    tolerance = 0.5 * spacing[0]
    for i in range(start, stop):
        if sign * (node_position[i, axis] - plane) >= -tolerance:
            for d in range(dim):
                if velocity[d] == velocity[d]:
                    node_momentum[i, d] = node_mass[i] * velocity[d]


@dataclass(frozen=True, slots=True)
class PrescribedSide:
    """One side of a body's bounding box at the start, moving with its prescribed velocity."""

    body: Body
    axis: int
    upper: bool  #: the side at the upper end of the axis
    velocity: FloatArray  #: (dim,) [m/s]; NaN leaves a component free

    @property
    def sign(self) -> float:
        """Direction of the outward normal along the axis."""
        return 1.0 if self.upper else -1.0

    def plane(self, time: float) -> float:
        """Coordinate of the side at ``time`` [m]."""
        start = (self.body.upper if self.upper else self.body.lower)[self.axis]
        speed = self.velocity[self.axis]
        return float(start + (0.0 if np.isnan(speed) else speed * max(time, 0.0)))


class Constraint:
    """Boundary conditions on the grid: the last word on the nodal momentum of a body's own velocity field."""

    name = "constraint"

    def __init__(self, sides: tuple[PrescribedSide, ...]) -> None:
        self.sides = sides

    @hookimpl
    def constrain_momentum(self, grid: Grid, time: float) -> None:
        """Set the momentum of the nodes on and beyond each side."""
        for side in self.sides:
            nodes = grid.field_nodes(side.body.field)
            prescribe_side(
                nodes.start,
                nodes.stop,
                side.axis,
                side.sign,
                side.plane(time),
                side.velocity,
                grid.position,
                grid.mass,
                grid.momentum,
                grid.spacing,
            )
