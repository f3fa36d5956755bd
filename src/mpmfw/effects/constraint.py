"""Fixed sides and sides with prescribed velocity."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from mpmfw.effects.series import cross
from mpmfw.effects.side_impulses import meet
from mpmfw.effects.side_rows import AXIS, PlaneSides, SideTable, list_rows, tabulate
from mpmfw.errors import SceneError
from mpmfw.plugin.hookspecs import hookimpl
from mpmfw.plugin.setup import FLAT, Acts, Setup
from mpmfw.scene.bodies import motion_of, side_labels
from mpmfw.state.fields import AnyArray, Field, FloatArray
from mpmfw.state.history import IndexMap
from mpmfw.state.structs import Body, Grid
from mpmfw.units import TimeTable

if TYPE_CHECKING:
    from mpmfw.scene.bodies import Side
    from mpmfw.scene.tables import Settle

FIELDS = (
    Field("side_reaction", ("side", "axis"), "N m-1",
          "force of a prescribed side on the body, mean over the output interval", "series", output=True,
          mean=True),
    Field("side_work", ("side",), "J m-1", "work of a moving side on the body since time zero", "series",
          output=True),
)  # fmt: skip
MOMENT = Field("side_moment", ("side", "rotation"), "N m m-1",
               "moment of a prescribed side on the body about output.side_moment, mean over the interval",
               "series", output=True, mean=True)  # fmt: skip

#: Largest number of passes over the rows; one meets those of a single side.
PASSES = 100

#: Change of a side's velocity that ends the passes, as a share of the bodies' wave speed.
AGREED = 1e-10


class Constraint:
    """Prescribed sides: the last change of the nodal momenta."""

    name = "constraint"
    ledger_term = ("external", "prescribed sides")
    history = ("planes", "works", "impulse", "moved_for", "force", "twist", "moment")

    def __init__(self, setup: Setup, sides: list[tuple[Body, Side]], tables: list[TimeTable]) -> None:
        shape, bodies = setup.shape_function, [body for body, _ in sides]
        self.bodies, self.degree, self.state = bodies, shape.boundary_degree, setup.state
        self.tables = tables  #: of the sides' velocities
        #: Calls in each step that move the body: that of MUSL after the second projection moves nothing.
        self.calls = self.left = 2 if setup.scheme == "usf" else 1
        self.works = np.zeros(len(sides))  #: of each side on its body so far [J/m]
        #: of each side along its directions since the last output, (n_sides, dim) [N s/m]
        self.impulse = np.zeros((len(sides), setup.dim))
        #: Time for which each body was stepped since the last output [s], and its mean force; a body that
        #: sleeps keeps its force.
        self.moved_for, self.force = np.zeros(len(sides)), np.zeros((len(sides), setup.dim))
        #: Point of the moments [m]; None has none. Moments since the last output, and their mean.
        self.about = setup.scene.output.side_moment
        axes_of_turn = 0 if self.about is None else 1 if setup.dim == 2 else 3
        self.twist, self.moment = np.zeros((2, len(sides), axes_of_turn))
        labels = side_labels(setup.scene)
        #: place of each side among those of the results, where conditions on one side are one
        self.place = [labels.index(f"{body.name}-{side.side}") for body, side in sides]
        self.n_labels = len(labels)
        #: While a scene settles, moving sides are held where they are.
        self.at_rest = False
        faces = [setup.face_of(body, side) for body, side in sides]
        _refuse_corners(sides, faces, FLAT * setup.cell_size)
        #: unit vectors along the body's own axes, (n_sides, dim, dim), one a row
        self.directions = np.array([setup.scene.bodies[body.name].geometry.axes for body in bodies])
        self.planes = _planes(setup, bodies, faces, self.degree, 2 if shape.staggered else 1)
        along = [axes @ normal for axes, (normal, _) in zip(self.directions, faces, strict=True)]
        own = [int(np.abs(each).argmax()) for each in along]
        signs = np.array([each[k] for each, k in zip(along, own, strict=True)])
        self.along = np.arange(len(sides)), own, signs
        self._prescribe([table.at(0.0) for table in tables])
        self.free = np.flatnonzero(np.isnan(self.speeds)).tolist()
        self.motions = np.zeros(len(sides))
        self.agreed = AGREED * max(body.wave_speed for body in bodies)
        self.frame, self.listed = -1, False  #: whether the rows are those of this step

    def _prescribe(self, velocity: Sequence[FloatArray]) -> None:
        #: components along ``directions``, (n_sides, dim) [m/s]; NaN leaves one free
        self.velocity = np.array(velocity)
        self.pace = np.nan_to_num(self.velocity)
        side, component, sign = self.along
        #: along the normal, (n_sides,) [m/s]; NaN where it is free
        self.speeds = sign * self.velocity[side, component]

    @property
    def work(self) -> float:
        """Work of all moving sides so far [J/m]."""
        return float(self.works.sum())

    @classmethod
    def from_setup(cls, setup: Setup) -> Acts:
        held = setup.held_sides
        tables = [motion_of(side, setup.dim) for _, side in held]
        in_time = any(len(table.times) > 1 for table in tables)
        made = (ConstraintInTime if in_time else cls)(setup, held, tables)
        return Acts(", ".join(f"{body.name} {side.side}" for body, side in held), [made])

    def while_settling(self, asked: Settle | None) -> None:
        """Hold moving sides where they are, until ``asked`` is None."""
        self.at_rest = asked is not None

    def copy_history(self, other: Constraint, index_map: IndexMap) -> None:
        """Copy the places of sides, renumbered by ``index_map``, and the work."""
        here = [int(index_map.body[body.index]) for body in other.bodies]
        theirs = [k for k, body in enumerate(here) if body >= 0]
        ours = [k for k, b in enumerate(self.bodies) if b.index in here]
        self.planes.place[ours] = other.planes.place[theirs]
        self.force[ours], self.moment[ours] = other.force[theirs], other.moment[theirs]
        for name in ("works", "impulse", "moved_for", "twist"):
            getattr(self, name)[ours] += getattr(other, name)[theirs]
            getattr(other, name)[theirs] = 0.0

    def held_momentum(self, grid: Grid) -> FloatArray:
        """Return momenta that satisfy the prescribed sides, (n_nodes, dim) [kg/s]."""
        held = dataclasses.replace(grid, momentum=grid.momentum.copy())
        self._meet(held)
        return held.momentum

    @hookimpl
    def constrain_momentum(self, grid: Grid) -> None:
        self._meet(grid)
        if self.left > 0:
            self.impulse += self.table.impulse
            if self.about is not None and self.rows:
                self._add_moments(grid)
            if not self.at_rest:
                self.works += (self.table.impulse * self.pace).sum(axis=1)
        self.left -= 1

    def _add_moments(self, grid: Grid) -> None:
        """Add Σ (x_r − x_0) × J_r over the rows of each side; rows of extrapolation have none."""
        table, rows = self.table, slice(self.rows)
        entries = slice(0, int(table.row[self.rows]))
        place = table.weights[entries, None] * grid.position[table.nodes[entries]]
        arm = np.add.reduceat(place, table.row[rows]) - table.target[rows, None] * np.array(self.about)
        impulse = np.einsum("re,red->rd", table.applied[rows], self.directions[table.side[rows]])
        np.add.at(self.twist, table.side[rows], cross(arm, impulse))

    def _meet(self, grid: Grid) -> None:
        self._fit(grid)
        self.table.impulse[:] = 0.0
        if not self.listed:
            self.rows = list_rows(
                self.degree, self.planes, grid.position, grid.mass, self.table, grid.spacing
            )
            self.listed = True
        velocity = 0.0 * self.velocity if self.at_rest else self.velocity
        self.passes = meet(
            self.rows, self.table, self.directions, velocity, PASSES, self.agreed, grid.mass, grid.momentum,
            grid.spacing,
        )  # fmt: skip

    def _fit(self, grid: Grid) -> None:
        """Make room for the table, and find columns, in new windows."""
        if self.frame == grid.frame:
            return
        self.frame, self.listed = grid.frame, False
        width = 2 + int(2.0 * self.planes.reach.max())
        rows, longest = 0, 0
        for body, column in zip(self.bodies, self.planes.column, strict=True):
            nodes, shape, axis = grid.field_nodes(body.field), grid.window_shape[body.field], column[AXIS]
            count = int(shape[axis])
            column[:AXIS] = nodes.start, nodes.stop, int(np.prod(shape[axis + 1 :])), count
            rows += (width + 1) * (nodes.stop - nodes.start) // count
            longest = max(longest, count)
        self.table = SideTable(
            row=np.zeros(rows + 1, dtype=np.int64),
            nodes=np.zeros(rows * width, dtype=np.int64),
            weights=np.zeros(rows * width),
            target=np.zeros(rows),
            side=np.zeros(rows, dtype=np.int64),
            first=np.zeros(rows, dtype=np.int64),
            factor=np.zeros((rows, width + 1)),
            push=np.zeros_like(grid.momentum),
            **{
                name: np.zeros((rows, grid.dim))
                for name in ("missing", "divided", "answer", "search", "change", "step")
            },
            c=np.zeros(longest),
            distance=np.zeros(longest),
            impulse=np.zeros_like(self.velocity),
            applied=np.zeros((0 if self.about is None else rows, len(self.pace[0]))),
        )

    @hookimpl
    def advect(self, grid: Grid, dt: float) -> None:
        """Move each side as prescribed, or with the body's mean velocity."""
        self.moved_for += dt
        self.motions[:] = 0.0 if self.at_rest else dt * self.speeds
        for index in self.free:
            self.motions[index] = dt * self._mean_speed(index, grid.velocity)

    def _mean_speed(self, index: int, velocity: FloatArray) -> float:
        """Mean velocity of the body along a side's normal, over its columns [m/s]."""
        if self.rows == 0:
            return 0.0
        table = self.table
        entries = slice(0, int(table.row[self.rows]))
        parts = table.weights[entries] * (velocity[table.nodes[entries]] @ self.planes.normal[index])
        at_side = np.add.reduceat(parts, table.row[: self.rows])
        own = (table.side[: self.rows] == index) & (table.target[: self.rows] > 0.0)
        return float(at_side[own].mean()) if own.any() else 0.0

    @hookimpl
    def end_step(self) -> None:
        np.add(self.planes.place, self.motions, out=self.planes.place)
        self.left, self.listed = self.calls, False

    @hookimpl
    def declare_fields(self) -> list[Field]:
        return [*FIELDS, *([] if self.about is None else [MOMENT])]

    @hookimpl
    def diagnostics(self, interval: float) -> dict[str, AnyArray]:
        """Return mean forces since the last output, zero at the first, and the works."""
        stepped = self.moved_for > 0.0
        impulse = np.einsum("se,sed->sd", self.impulse, self.directions)
        if interval > 0.0:
            self.force[stepped] = impulse[stepped] / self.moved_for[stepped, None]
            self.moment[stepped] = self.twist[stepped] / self.moved_for[stepped, None]
        self.impulse[:], self.moved_for[:], self.twist[:] = 0.0, 0.0, 0.0
        series = {"side_reaction": self.force, "side_work": self.works}
        series |= {} if self.about is None else {"side_moment": self.moment}
        return {name: self._by_label(values) for name, values in series.items()}

    def _by_label(self, values: FloatArray) -> FloatArray:
        """Return sums over the conditions of each side."""
        sums = np.zeros((self.n_labels, *values.shape[1:]))
        np.add.at(sums, self.place, values)
        return sums


class ConstraintInTime(Constraint):
    """Prescribed sides, of which some change their velocity in time."""

    @hookimpl
    def after_momentum_projection(self, dt: float) -> None:
        """Take the velocities' means over the step of ``dt`` [s]."""
        self._prescribe([table.mean(self.state.time, dt) for table in self.tables])


def _planes(
    setup: Setup, bodies: list[Body], faces: list[tuple[FloatArray, float]], degree: int, grids: int
) -> PlaneSides:
    """Return the sides as arrays; of their columns only the axis is known yet.

    A side acts everywhere in a velocity field of its body alone, else within a cell round the body."""
    cell, dim, alone = setup.cell_size, setup.dim, setup.field_per_body
    rim = np.inf if alone else 1.01 * cell
    column, weights = np.zeros((len(bodies), 5), dtype=np.int64), []
    for place, (normal, _) in zip(column, faces, strict=True):
        size = np.abs(normal)
        place[AXIS] = np.flatnonzero(size > size.max() - 1e-9)[0]  # nearest to the normal, the first of two
        weights.append(tabulate(normal, int(place[AXIS]), degree, grids))
    node_volume, grid = (grids * cell) ** dim / grids, setup.state.grid
    around = [grid.around(body.lower[0]) if grid.axisymmetric else 1.0 for body in bodies]
    return PlaneSides(
        normal=np.array([normal for normal, _ in faces]),
        place=np.array([place for _, place in faces]),
        box_lower=np.array([body.lower for body in bodies]) - rim,
        box_upper=np.array([body.upper for body in bodies]) + rim,
        alone=np.full(len(bodies), int(alone), dtype=np.int64),
        cell_mass=np.array([body.areal_density * node_volume for body in bodies]) * around,
        reach=np.array([reach for reach, _ in weights]),
        tabulated=np.cumsum([0, *(len(values) for _, values in weights)]),
        weight=np.concatenate([values for _, values in weights]),
        column=column,
        lower=np.array(setup.state.grid.lower, dtype=float),
        grids=np.array([grids]),
    )


def _refuse_corners(
    sides: list[tuple[Body, Side]], faces: list[tuple[FloatArray, float]], within: float
) -> None:
    """Refuse sides along which no facet lies ``within`` a distance [m]."""
    for (body, side), (normal, place) in zip(sides, faces, strict=True):
        at_side = [np.abs(loop @ normal - place) <= within for loop in body.outlines]
        along = [on[corners].all(axis=1).any() for on, corners in zip(at_side, body.facets, strict=True)]
        if along and not any(along):
            text = f"no part of the outline lies along the side '{side.side}'"
            raise SceneError(text, key=f"bodies.{body.name}.sides")
