"""Base class of all tables of a scene, and the types of their values."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, Strict

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
    alternatives,
    array_of,
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
Spin = alternatives(array_or_single, single=AngularVelocity, array=array_of(AngularVelocity, 3, 3))

#: ``true`` for all components, or the components that are fixed.
FixedComponents = alternatives(array_or_single, single=Literal[True], array=array_of(Axis, 1, 3))

#: ``"centre_of_mass"`` of every body, or one point.
MomentPoint = alternatives(array_or_single, single=Literal["centre_of_mass"], array=Position)

_Component = alternatives(
    lambda value: "free" if value == "free" else "value", free=Literal["free"], value=Velocity
)
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
