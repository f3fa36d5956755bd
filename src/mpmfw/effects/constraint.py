"""Fixed sides and sides with prescribed velocity."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from mpmfw.fields import FloatArray
from mpmfw.hookspecs import hookimpl
from mpmfw.kernels import kernel
from mpmfw.kernels.types import Floats
from mpmfw.setup import Setup
from mpmfw.state import Body, Grid


@kernel
def prescribe_side(
    start: int,
    stop: int,
    axis: int,
    sign: float,
    plane: float,
    velocity: Floats,
    box_lower: Floats,
    box_upper: Floats,
    node_position: Floats,
    node_mass: Floats,
    node_momentum: Floats,
    spacing: tuple[float, ...],
) -> None:
    """(m v)_i = m_i v on nodes ``start:stop`` that lie on or beyond the plane, sign (x_axis − plane) > −h/2.

    Only nodes within ``box_lower … box_upper`` count, so that in a field that bodies share a side holds its own body alone.
    A plane between two nodes is taken to lie on the nearer one: a side that is pulled outwards would lose
    hold of its nodes at once if only those beyond it counted. Components of ``velocity`` that are NaN stay
    free.
    """
    dim = len(spacing)
    tolerance = (0.5 - 1e-6) * spacing[0]  # a plane in mid-cell lies on the outer node, whatever the rounding
    for i in range(start, stop):
        inside = sign * (node_position[i, axis] - plane) >= -tolerance
        for d in range(dim):
            inside = inside and box_lower[d] <= node_position[i, d] <= box_upper[d]
        if inside:
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
    alone: bool = True  #: whether no other body shares the velocity field

    @property
    def sign(self) -> float:
        """Direction of the outward normal along the axis."""
        return 1.0 if self.upper else -1.0

    def plane(self, time: float) -> float:
        """Coordinate of the side at ``time`` [m]."""
        start = (self.body.upper if self.upper else self.body.lower)[self.axis]
        speed = self.velocity[self.axis]
        return float(start + (0.0 if np.isnan(speed) else speed * max(time, 0.0)))

    def box(self, cell_size: float) -> tuple[FloatArray, FloatArray]:
        """Where its nodes may lie: everywhere in a field of the body's own, else a cell round the body at the start."""
        lower, upper = np.array(self.body.lower), np.array(self.body.upper)
        rim = np.inf if self.alone else 1.01 * cell_size
        return lower - rim, upper + rim


class Constraint:
    """Boundary conditions on the grid: the last word on the nodal momentum of a body's own velocity field."""

    name = "constraint"

    def __init__(self, sides: tuple[PrescribedSide, ...]) -> None:
        self.sides = sides
        #: While a scene settles, moving sides are held where they are.
        self.at_rest = False

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Where each side's nodes may lie."""
        self.boxes = [side.box(setup.cell_size) for side in self.sides]

    def held_momentum(self, grid: Grid, time: float) -> FloatArray:
        """Nodal momenta as :meth:`constrain_momentum` would leave them, (n_nodes, dim) [kg/s]; those of ``grid`` stay."""
        held = dataclasses.replace(grid, momentum=grid.momentum.copy())
        self.constrain_momentum(held, time)
        return held.momentum

    @hookimpl
    def constrain_momentum(self, grid: Grid, time: float) -> None:
        """Set the momentum of the nodes on and beyond each side."""
        for side, (lower, upper) in zip(self.sides, self.boxes, strict=True):
            nodes = grid.field_nodes(side.body.field)
            prescribe_side(
                nodes.start,
                nodes.stop,
                side.axis,
                side.sign,
                side.plane(0.0 if self.at_rest else time),
                0.0 * side.velocity if self.at_rest else side.velocity,
                lower,
                upper,
                grid.position,
                grid.mass,
                grid.momentum,
                grid.spacing,
            )
