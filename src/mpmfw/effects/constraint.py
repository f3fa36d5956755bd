"""Fixed sides and sides with prescribed velocity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mpmfw.effects.side_rows import add_rows, meet, quadrature
from mpmfw.fields import FloatArray
from mpmfw.hookspecs import hookimpl
from mpmfw.setup import Setup
from mpmfw.state import Body, Grid

#: Largest number of passes over sides that share nodes: near corners they do, and two sides may ask for different velocities.
PASSES = 100

#: Change of a side's velocity that ends the passes, as a share of a body's wave speed.
AGREED = 1e-14


@dataclass(frozen=True, slots=True)
class PrescribedSide:
    """One plane side of a body, with the velocity that is prescribed on it."""

    body: Body
    normal: FloatArray  #: outward unit normal n, (dim,)
    place: float  #: n·x on the side at the start [m]
    directions: FloatArray  #: (dim, dim), one unit vector a row: the body's own axes
    velocity: FloatArray  #: (dim,) along these [m/s]; NaN leaves a component free
    alone: bool = True  #: whether no other body shares the velocity field

    @property
    def axis(self) -> int:
        """Axis of the grid to which the normal is nearest."""
        return int(np.argmax(np.abs(self.normal) > np.abs(self.normal).max() - 1e-9))

    @property
    def speed(self) -> float:
        """Prescribed velocity along the normal [m/s]; NaN where it is free."""
        along = self.directions @ self.normal
        return float(along[np.abs(along) > 0.5] @ self.velocity[np.abs(along) > 0.5])

    def box(self, cell_size: float) -> tuple[FloatArray, FloatArray]:
        """Where its columns may lie: everywhere in a field of the body's own, else a cell round the body at the start."""
        lower, upper = np.array(self.body.lower), np.array(self.body.upper)
        rim = np.inf if self.alone else 1.01 * cell_size
        return lower - rim, upper + rim


class Constraint:
    """Boundary conditions on the grid: the last word on the nodal momentum of a body's own velocity field.

    Parameters
    ----------
    sides
        In the scene's order.
    degree
        Of the shape function's boundary basis.
    """

    name = "constraint"

    def __init__(self, sides: tuple[PrescribedSide, ...], degree: int) -> None:
        self.sides, self.degree = sides, degree
        #: While a scene settles, moving sides are held where they are.
        self.at_rest = False

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Where the sides are, and what does not change of them."""
        self.frame = -1
        self.places = [side.place for side in self.sides]
        self.moved = [0.0] * len(self.sides)
        self.boxes = [side.box(setup.cell_size) for side in self.sides]
        self.points = [quadrature(side.normal, side.axis, self.degree) for side in self.sides]
        self.cell_mass = [side.body.density * setup.cell_size**setup.dim for side in self.sides]
        self.directions = np.array([side.directions for side in self.sides])
        self.velocity = np.array([side.velocity for side in self.sides])
        self.agreed = AGREED * max(side.body.wave_speed for side in self.sides)

    @hookimpl
    def constrain_momentum(self, grid: Grid) -> None:
        """Bring the velocity at every side to the prescribed one."""
        self._fit(grid)
        rows = 0
        for index in range(len(self.sides)):
            before = rows
            rows = self._add_rows(index, grid, rows)
            self.side[before:rows] = index
        self.rows=rows
        self.count=meet(
            rows,
            self.row,
            self.nodes,
            self.weights,
            self.side,
            self.on_side,
            self.directions,
            0.0 * self.velocity if self.at_rest else self.velocity,
            PASSES,
            self.agreed,
            grid.mass,
            grid.momentum,
            grid.spacing,
        )

    def _fit(self, grid: Grid) -> None:
        if self.frame == grid.frame:
            return
        self.frame = grid.frame
        count = 0
        for side in self.sides:
            nodes, shape = grid.field_nodes(side.body.field), grid.window_shape[side.body.field]
            count += (nodes.stop - nodes.start) // int(shape[side.axis])
        count*=5
        self.row=np.zeros(count+1,dtype=np.int64)
        self.nodes=np.zeros(count*10,dtype=np.int64)
        self.weights=np.zeros(count*10)
        self.side=np.zeros(count,dtype=np.int64)
        self.on_side=np.zeros(count,dtype=np.int64)

    def _add_rows(self, index: int, grid: Grid, rows: int) -> int:
        side = self.sides[index]
        nodes, shape = grid.field_nodes(side.body.field), grid.window_shape[side.body.field]
        return add_rows(
            rows,
            nodes.start,
            nodes.stop,
            int(np.prod(shape[side.axis + 1 :])),
            int(shape[side.axis]),
            side.axis,
            side.normal,
            self.places[index],
            *self.boxes[index],
            self.degree,
            *self.points[index],
            self.cell_mass[index],
            side.alone,
            grid.position,
            grid.mass,
            np.empty(int(shape[side.axis])),
            self.row,
            self.nodes,
            self.weights,
            self.on_side,
            grid.spacing,
        )

    @hookimpl
    def advect(self, dt: float) -> None:
        """How far the sides move in this step, after which they are where the shape functions' points are."""
        for index, side in enumerate(self.sides):
            speed = 0.0 * side.speed if self.at_rest else side.speed
            if np.isnan(speed):
                speed = 0.0
            self.moved[index] = dt * speed

    @hookimpl
    def end_step(self) -> None:
        """Move the sides."""
        for index in range(len(self.sides)):
            self.places[index] += self.moved[index]
