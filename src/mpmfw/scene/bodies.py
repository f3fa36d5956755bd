"""Tables of bodies, of their sides and of their initial stress."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

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
from mpmfw.scene.rigid import OfDeformable, RigidTable
from mpmfw.units import Density, Length, Number, Pressure

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
