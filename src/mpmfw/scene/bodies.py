"""Tables of bodies, of their sides and of their initial stress; checks of sides that run into each other."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import Discriminator, Field, Strict, Tag, model_validator
from pydantic.json_schema import SkipJsonSchema

from mpmfw.geometry import Geometry, Particles
from mpmfw.geometry.base import LengthInCells, PositiveLength
from mpmfw.scene.base import (
    FixedComponents,
    Position,
    SideForce,
    SidePressure,
    SideTraction,
    SideVelocity,
    Spin,
    Table,
    VelocityVector,
)
from mpmfw.scene.problem import Path, Problem
from mpmfw.scene.rigid import OfDeformable, RigidTable
from mpmfw.units import Density, Length, Number, Pressure, TimeTable

if TYPE_CHECKING:
    from mpmfw.scene.scene import Scene

#: A depth, and vertical and horizontal pressure there.
StressRow = Annotated[tuple[Annotated[Length, Field(ge=0)], Pressure, Pressure], Strict(False)]


class InitialStress(Table):
    """Initial stress of soil by depth below ``top`` [m], by default the top of the body's box.

    The vertical stress is the weight above, with the ``density`` [kg/m^3] or by default the body's; the
    horizontal stress is ``k0`` times that. Alternatively ``table`` has rows (depth [m], vertical, horizontal
    pressure [Pa])."""

    k0: Annotated[Number, Field(ge=0)] | None = None
    density: Annotated[Density, Field(gt=0)] | None = None
    top: Length | None = None
    table: Annotated[tuple[StressRow, ...], Strict(False), Field(min_length=2)] | None = None

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        """Refuse both forms, neither, and depths out of order."""
        if (self.k0 is None) == (self.table is None) or (self.table and self.density is not None):
            raise ValueError("expected k0 or table; density goes with k0")
        if self.table is not None and np.any(np.diff([row[0] for row in self.table]) <= 0.0):
            raise ValueError("expected depths that increase from row to row of table")
        return self


class Side(Table):
    """A condition on a side: fixed components, a velocity [m/s], a pressure or traction [Pa], a force [N].

    The force acts on the whole side over the body's thickness, spread evenly. All but fixed are constant, or
    rows of a time [s] and its values: linear in between, constant outside."""

    #: A plane side, or for a load the whole outside of the body, or all its holes.
    side: Literal["left", "right", "bottom", "top", "back", "front", "outer", "inner"]
    #: Corners of a box [m]: a load acts on the side's facets whose centre lies in it at the start.
    within: Annotated[tuple[Position, Position], Strict(False)] | None = None
    fixed: FixedComponents | None = None
    velocity: SideVelocity | None = None
    pressure: SidePressure | None = None
    traction: SideTraction | None = None
    force: SideForce | None = None

    @functools.cached_property
    def is_loaded(self) -> bool:
        """Return True if the side has a load, and no prescribed motion."""
        return self.pressure is not None or self.traction is not None or self.force is not None

    @property
    def is_constant(self) -> bool:
        """Return True if the side does not move and its loads are constant."""
        loads = (self.pressure, self.traction, self.force)
        changing = any(isinstance(load, tuple) and isinstance(load[0], tuple) for load in loads)
        return self.velocity is None and not changing


class Body(Table):
    """One body; without ``velocity`` and ``angular_velocity`` it starts at rest."""

    material: str
    geometry: Geometry
    particles: Particles
    #: Length of the surface's segments, in 3D of the sides of its triangles [m]: see :meth:`segment_length`.
    segment: LengthInCells | None = None
    velocity: VelocityVector | None = None  #: at the start [m/s]
    angular_velocity: Spin | None = None  #: at the start, about the centroid [rad/s]
    #: Treatment of rotational inertia; None lets the build decide.
    rotation: Literal["spin", "exact", "lumped"] | None = None
    #: Change of volume at points or averaged over cells, against locking: see ``Setup.averaged_bodies``.
    volumetric: Literal["auto", "averaged", "pointwise"] = "auto"
    initial_stress: InitialStress | None = None  #: of soil in its own weight
    self_contact: bool = False  #: parts of its surface may touch each other
    thickness: PositiveLength | None = None  #: in the plane, across it [m]; None is 1 m
    sides: Annotated[tuple[Side, ...], Strict(False)] = ()

    def segment_length(self, cell_size: float) -> float:
        """Length of the surface's segments [m]: as given, or a quarter of a cell, in 3D half of one."""
        share = 0.25 if self.geometry.dim == 2 else 0.5
        return share * cell_size if self.segment is None else float(self.segment)

    @property
    def prescribed(self) -> bool:
        """Return True if the body is rigid and no force moves it."""
        return False


class RigidBody(Body):
    """A rigid body; ``rigid`` gives its motion. A free one may start with a velocity."""

    rigid: RigidTable
    material: SkipJsonSchema[OfDeformable] = ""
    particles: SkipJsonSchema[OfDeformable] = None
    rotation: SkipJsonSchema[OfDeformable] = None
    volumetric: SkipJsonSchema[OfDeformable] = None
    initial_stress: SkipJsonSchema[OfDeformable] = None
    self_contact: SkipJsonSchema[OfDeformable] = None
    sides: SkipJsonSchema[OfDeformable] = ()

    @property
    def prescribed(self) -> bool:
        return self.rigid is True or self.rigid.motion is not None


def _kind_of_body(value: Any) -> str:
    rigid = isinstance(value, RigidBody) or (isinstance(value, Mapping) and "rigid" in value)
    return "a rigid body" if rigid else "a deformable body"


AnyBody = Annotated[
    Annotated[Body, Tag("a deformable body")] | Annotated[RigidBody, Tag("a rigid body")],
    Discriminator(_kind_of_body),
]


#: Axis of the body across each side, and the sides at its upper end.
AXIS = {"left": 0, "right": 0, "bottom": 1, "top": 1, "back": 2, "front": 2}
UPPER = ("right", "top", "front")


def rows_of(velocity: Any) -> tuple[Any, ...]:
    """Return the rows (t, v_x, v_y[, v_z]) of a side's velocity, one of a constant one."""
    return velocity if isinstance(velocity[0], tuple) else ((0.0, *velocity),)


def motion_of(side: Side, dim: int) -> TimeTable:
    """Return the prescribed velocity of a side, (dim,) [m/s]; NaN for a component that is free."""
    if side.velocity is not None:
        return TimeTable([[np.nan if v == "free" else v for v in row] for row in rows_of(side.velocity)])
    fixed = "xyz" if side.fixed is True else side.fixed or ()
    return TimeTable.constant([0.0 if name in fixed else np.nan for name in "xyz"[:dim]])


def side_labels(scene: Scene) -> tuple[str, ...]:
    """Return the labels ``body-side`` of prescribed sides, once each."""
    held = [(name, side) for name, body in scene.bodies.items() for side in body.sides if not side.is_loaded]
    return tuple(dict.fromkeys(f"{name}-{side.side}" for name, side in held))


def check_sides(body: Body, path: Path, dim: int, end: float) -> Iterator[Problem]:
    """Yield contradictions between the prescribed sides of a body at ``path``, until time ``end`` [s]."""
    plane = [(index, side) for index, side in enumerate(body.sides) if side.side in AXIS]
    for (_, first), (index, second) in itertools.combinations(plane, 2):
        at = (*path, "sides", index)
        if AXIS[first.side] == AXIS[second.side] and first.side != second.side:
            if text := _meeting(body, first, second, dim, end):
                yield Problem(at, text)
        elif first.side == second.side or body.geometry.type in ("rectangle", "box"):
            yield from _contradicting(first, second, at, dim)


def _contradicting(first: Side, second: Side, at: Path, dim: int) -> Iterator[Problem]:
    """Return components that both sides prescribe, with different values, on nodes that they share."""
    where = "" if first.side == second.side else ", with which it shares a corner,"
    one, other = motion_of(first, dim), motion_of(second, dim)
    times = np.union1d(one.times, other.times)
    values = np.array([[table.at(time) for table in (one, other)] for time in times])
    for axis in range(dim):
        own, given = values[:, :, axis].T
        if (differ := ~np.isnan(own + given) & (own != given)).any():
            k, name = differ.argmax(), "xyz"[axis]
            when = f" at {times[k]:g} s" if len(times) > 1 else ""
            message = (
                f"prescribes {given[k]:g} m/s along {name}{when}, but side '{first.side}'{where} prescribes "
                f"{own[k]:g} m/s; expected the same value, or '{name}' free on one of them"
            )
            yield Problem(at, message)


def _meeting(body: Body, first: Side, second: Side, dim: int, end: float) -> str:
    """Return when two opposite sides meet; empty if they do not before the end."""
    lower, upper = (second, first) if first.side in UPPER else (first, second)
    if body.geometry.type == "mesh":
        return ""
    axis, below, above = AXIS[lower.side], motion_of(lower, dim), motion_of(upper, dim)
    low, high = body.geometry.bounds[:, axis]
    times = np.union1d(np.linspace(0.0, end, 101), [*below.times, *above.times])
    times = times[(times >= 0.0) & (times <= end)]
    speeds = [np.interp(times, table.times, table.values[:, axis]) for table in (below, above)]
    approach = speeds[0] - speeds[1]
    travelled = np.append(0.0, np.cumsum(0.5 * np.diff(times) * (approach[1:] + approach[:-1])))
    k = int((travelled >= high - low).argmax())
    if k == 0:
        return ""
    time = np.interp(high - low, travelled[k - 1 : k + 1], times[k - 1 : k + 1])
    return (
        f"meets side '{first.side}' at {time:.4g} s, before time.end: their velocities "
        f"compress the body to nothing; expected time.end, which is {end:g} s, to be earlier"
    )
