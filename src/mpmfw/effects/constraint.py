"""Fixed sides and sides with prescribed velocity."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mpmfw.effects.side_rows import PlaneSides, SideTable, list_rows, meet, quadrature
from mpmfw.errors import SceneError
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import FLAT, Acts, Setup
from mpmfw.state.fields import FloatArray
from mpmfw.state.structs import Body, Grid

if TYPE_CHECKING:
    from mpmfw.scene.tables import Settle, Side
    from mpmfw.state.index_map import IndexMap

#: Largest number of passes over rows that share nodes; two sides may ask for different velocities at their
#: corner.
PASSES = 100

#: Change of a side's velocity that ends the passes, as a share of the bodies' wave speed.
AGREED = 1e-10


@dataclass(frozen=True, slots=True)
class PrescribedSide:
    """One plane side of a body, with the velocity that is prescribed on it."""

    body: Body
    normal: FloatArray  #: n, outward unit normal, (dim,)
    place: float  #: n·x on the side at the start [m]
    directions: FloatArray  #: unit vectors along the body's own axes, (dim, dim), one a row
    velocity: FloatArray  #: components along these, (dim,) [m/s]; NaN leaves one free
    alone: bool = True  #: whether no other body shares the velocity field

    @property
    def axis(self) -> int:
        """Axis of the grid to which the normal is nearest, the first of two."""
        size = np.abs(self.normal)
        return int(np.flatnonzero(size > size.max() - 1e-9)[0])

    @property
    def speed(self) -> float:
        """Prescribed velocity along the normal [m/s]; NaN where it is free."""
        along = self.directions @ self.normal
        own = int(np.abs(along).argmax())
        return float(along[own] * self.velocity[own])

    def box(self, cell_size: float) -> tuple[FloatArray, FloatArray]:
        """Return the box of its columns: everywhere in a velocity field of its body, else a cell round the
        body.
        """
        lower, upper = np.array(self.body.lower), np.array(self.body.upper)
        rim = np.inf if self.alone else 1.01 * cell_size
        return lower - rim, upper + rim


class Constraint:
    """Prescribed sides: the last change of the nodal momenta of the bodies' velocity fields.

    ``degree`` and ``staggered`` describe the shape function's boundary basis
    (:class:`mpmfw.api.shape.ShapeFunction`). ``calls`` is the number of calls in each step that move the
    body; that of MUSL after the second projection moves nothing."""

    name = "constraint"
    ledger_term = ("external", "prescribed sides")
    history = ("planes", "work")

    def __init__(
        self, sides: tuple[PrescribedSide, ...], degree: int, *, staggered: bool, calls: int
    ) -> None:
        self.sides, self.degree, self.grids = sides, degree, 2 if staggered else 1
        self.calls, self.left = calls, calls
        self.work = 0.0  #: of the moving sides on the bodies so far [J/m]
        #: While a scene settles, moving sides are held where they are.
        self.at_rest = False

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        """Return the fixed and moving sides of all bodies."""
        held, shape = setup.held_sides, setup.shape_function
        sides = tuple(_prescribed(setup, body, side) for body, side in held)
        calls = 2 if setup.scheme == "usf" else 1
        constraint = cls(sides, shape.boundary_degree, staggered=shape.staggered, calls=calls)
        return Acts(", ".join(f"{body.name} {side.side}" for body, side in held), [constraint])

    def while_settling(self, asked: Settle | None) -> None:
        """Hold moving sides where they are, until ``asked`` is None."""
        self.at_rest = asked is not None

    @hookimpl
    def setup(self, setup: Setup) -> None:
        """Allocate the places of the sides, and everything about them that does not change."""
        self.frame = -1
        self.speeds = np.array([side.speed for side in self.sides])
        self.free = np.flatnonzero(np.isnan(self.speeds)).tolist()
        self.motions = np.zeros(len(self.sides))
        self.planes = _planes(self.sides, setup.state.grid, self.degree, self.grids)
        self.directions = np.array([side.directions for side in self.sides])
        self.velocity = np.array([side.velocity for side in self.sides])
        self.agreed = AGREED * max(side.body.wave_speed for side in self.sides)

    def copy_history(self, other: Constraint, index_map: IndexMap) -> None:
        """Copy the places of sides, renumbered by ``index_map``, and the work."""
        self.work, other.work = self.work + other.work, 0.0
        theirs = [k for k, side in enumerate(other.sides) if index_map.body[side.body.index] >= 0]
        known = {int(index_map.body[other.sides[k].body.index]) for k in theirs}
        ours = [k for k, side in enumerate(self.sides) if side.body.index in known]
        self.planes.place[ours] = other.planes.place[theirs]

    def held_momentum(self, grid: Grid) -> FloatArray:
        """Nodal momenta as :meth:`constrain_momentum` would leave them, (n_nodes, dim) [kg/s]; those of
        ``grid`` stay.
        """
        held = dataclasses.replace(grid, momentum=grid.momentum.copy())
        self._meet(held)
        return held.momentum

    @hookimpl
    def constrain_momentum(self, grid: Grid) -> None:
        """Bring the velocity at every side to the prescribed one."""
        work = self._meet(grid)
        self.work, self.left = self.work + (work if self.left > 0 else 0.0), self.left - 1

    def _meet(self, grid: Grid) -> float:
        """Bring the velocity at every side to the prescribed one; return the work on moving sides [J/m]."""
        self._fit(grid)
        self.table.work[:] = 0.0
        self.rows = list_rows(self.degree, self.planes, grid.position, grid.mass, self.table, grid.spacing)
        velocity = 0.0 * self.velocity if self.at_rest else self.velocity
        self.passes = meet(
            self.rows, self.table, self.directions, velocity, PASSES, self.agreed, grid.mass, grid.momentum,
            grid.spacing
        )  # fmt: skip
        return float(self.table.work[0])

    def _fit(self, grid: Grid) -> None:
        """Make room for the table, and find each side's columns, whenever the windows were laid anew."""
        if self.frame == grid.frame:
            return
        self.frame = grid.frame
        width = 2 + int(self.degree + 1 + 2.0 * np.abs(self.planes.shift).max())
        rows, longest = 0, 0
        for index, side in enumerate(self.sides):
            nodes, shape, axis = (
                grid.field_nodes(side.body.field),
                grid.window_shape[side.body.field],
                side.axis,
            )
            count = int(shape[axis])
            stride = int(np.prod(shape[axis + 1 :]))
            self.planes.column[index] = (nodes.start, nodes.stop, stride, count, axis)
            rows += (width + 1) * (nodes.stop - nodes.start) // count
            longest = max(longest, count)
        self.table = SideTable(
            row=np.zeros(rows + 1, dtype=np.int64),
            nodes=np.zeros(rows * width, dtype=np.int64),
            weights=np.zeros(rows * width),
            target=np.zeros(rows),
            side=np.zeros(rows, dtype=np.int64),
            compliance=np.zeros(rows),
            c=np.zeros(longest),
            distance=np.zeros(longest),
            work=np.zeros(1),
        )

    @hookimpl
    def advect(self, grid: Grid, dt: float) -> None:
        """Compute each side's motion: as prescribed along its normal, or with the body's mean velocity."""
        self.motions[:] = 0.0 if self.at_rest else dt * self.speeds
        for index in self.free:
            self.motions[index] = dt * self._mean_speed(index, grid.velocity)

    def _mean_speed(self, index: int, velocity: FloatArray) -> float:
        """Mean velocity of the body along a side's normal, over its columns [m/s]."""
        if self.rows == 0:
            return 0.0
        table = self.table
        entries = slice(0, int(table.row[self.rows]))
        parts = table.weights[entries] * (velocity[table.nodes[entries]] @ self.sides[index].normal)
        at_side = np.add.reduceat(parts, table.row[: self.rows])
        own = (table.side[: self.rows] == index) & (table.target[: self.rows] > 0.0)
        return float(at_side[own].mean()) if own.any() else 0.0

    @hookimpl
    def end_step(self) -> None:
        """Move the sides, now that nobody asks for their place at the beginning of the step."""
        self.planes.place += self.motions
        self.left = self.calls


def _planes(sides: tuple[PrescribedSide, ...], grid: Grid, degree: int, grids: int) -> PlaneSides:
    """The sides as arrays; their columns are those of the windows, which are not known yet."""
    boxes = [side.box(grid.cell_size) for side in sides]
    points = [quadrature(side.normal, side.axis, degree) for side in sides]
    node_volume = (grids * grid.cell_size) ** grid.dim / grids
    return PlaneSides(
        normal=np.array([side.normal for side in sides]),
        place=np.array([side.place for side in sides]),
        box_lower=np.array([lower for lower, _ in boxes]),
        box_upper=np.array([upper for _, upper in boxes]),
        alone=np.array([side.alone for side in sides], dtype=np.int64),
        cell_mass=np.array([side.body.areal_density * node_volume for side in sides]),
        point=np.cumsum([0, *(len(shift) for shift, _ in points)]),
        shift=np.concatenate([shift for shift, _ in points]),
        share=np.concatenate([share for _, share in points]),
        column=np.zeros((len(sides), 5), dtype=np.int64),
        lower=np.array(grid.lower, dtype=float),
        grids=np.array([grids]),
    )


def _prescribed(setup: Setup, body: Body, side: Side) -> PrescribedSide:
    """Return a fixed or moving side; raise SceneError if the outline only touches it at a corner."""
    normal, place = setup.face_of(body, side)
    tolerance = FLAT * setup.cell_size
    at_side = [np.abs(loop @ normal - place) <= tolerance for loop in body.outlines]
    along = (on[corners].all(axis=1).any() for on, corners in zip(at_side, body.facets, strict=True))
    if body.outlines and not any(along):
        raise SceneError(
            f"no part of the outline lies along the side '{side.side}'", key=f"bodies.{body.name}.sides"
        )
    axes = setup.scene.bodies[body.name].geometry.axes
    velocity = _velocity(side, setup.dim)
    return PrescribedSide(body, normal, place, axes, velocity, alone=setup.field_per_body)


def _velocity(side: Side, dim: int) -> FloatArray:
    """Prescribed velocity of a side, NaN where a component is free."""
    if side.velocity is not None:
        return np.array([np.nan if isinstance(v, str) or v is None else float(v) for v in side.velocity])
    fixed = np.zeros(dim)
    if side.fixed is not None and side.fixed is not True:
        for d, name in enumerate("xyz"[:dim]):
            if name not in side.fixed:
                fixed[d] = np.nan
    return fixed
