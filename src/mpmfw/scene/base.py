"""Base class of all tables of a scene, and the types of their values."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Strict, Tag

from mpmfw.units import (
    Acceleration,
    AngularVelocity,
    Force,
    Length,
    Number,
    Pressure,
    Time,
    Torque,
    Velocity,
    array_or_single,
    axial_in_time,
    number_in_time,
    row_in_time,
    vector_in_time,
)


class Table(BaseModel):
    """A table of a scene: unknown keys are errors, types are not converted, values do not change.

    Only arrays may be given as lists or tuples.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


PositiveTime = Annotated[Time, Field(gt=0)]
NonNegativeTime = Annotated[Time, Field(ge=0)]
PositiveNumber = Annotated[Number, Field(gt=0)]
Friction = Annotated[Number, Field(ge=0)]
Axis: TypeAlias = Literal["x", "y", "z"]

_PLANE_OR_SPACE = Field(min_length=2, max_length=3)
Position = Annotated[tuple[Length, ...], Strict(False), _PLANE_OR_SPACE]
VelocityVector = Annotated[tuple[Velocity, ...], Strict(False), _PLANE_OR_SPACE]
AccelerationVector = Annotated[tuple[Acceleration, ...], Strict(False), _PLANE_OR_SPACE]

#: A number in 2D, a vector in 3D.
Spin = Annotated[
    Annotated[AngularVelocity, Tag("single")]
    | Annotated[tuple[AngularVelocity, AngularVelocity, AngularVelocity], Strict(False), Tag("array")],
    Discriminator(array_or_single),
]

#: ``true`` for all components, or the components that are fixed.
FixedComponents = Annotated[
    Annotated[Literal[True], Tag("single")]
    | Annotated[tuple[Axis, ...], Strict(False), Field(min_length=1, max_length=3), Tag("array")],
    Discriminator(array_or_single),
]

#: ``"centre_of_mass"`` of every body, or one point.
MomentPoint = Annotated[
    Annotated[Literal["centre_of_mass"], Tag("single")] | Annotated[Position, Tag("array")],
    Discriminator(array_or_single),
]

_Component = Annotated[
    Annotated[Literal["free"], Tag("free")] | Annotated[Velocity, Tag("value")],
    Discriminator(lambda value: "free" if value == "free" else "value"),
]
#: Velocity of a side, or rows (t, v_x, v_y[, v_z]); ``"free"`` for a component that is left to the body.
SideVelocity = vector_in_time(_Component)

#: One row of a table of gravity: time, then the components.
GravityRow = row_in_time(Acceleration)
#: A pressure, or rows (t, p).
SidePressure = number_in_time(Pressure)
#: A vector, or rows (t, t_x, t_y[, t_z]).
SideTraction = vector_in_time(Pressure)
#: A vector, or rows (t, f_x, f_y[, f_z]).
SideForce = vector_in_time(Force)
#: A vector, or rows (t, v_x, v_y[, v_z]).
VelocityInTime = vector_in_time(Velocity)
#: A number in 2D, a vector in 3D, or rows of a time and either.
SpinInTime = axial_in_time(AngularVelocity)
TorqueInTime = axial_in_time(Torque)
