"""Annotations of options that have a unit, and tables in time.

``Length``, ``Time``, ``Velocity``, ``AngularVelocity``, ``Acceleration``, ``Angle``, ``Pressure``, ``Force``,
``Density`` and ``Number`` are annotations for fields of an ``Options`` model in m, s, m/s, rad/s, m/s^2, rad,
Pa, N, kg/m^3 and 1. A scene gives a bare number in that unit, or a string with any unit that converts to it;
the plug-in gets a float. A unit of another kind is refused. ``quantity`` makes an annotation for any other
unit."""

from __future__ import annotations

from mpmfw.units import (
    Acceleration,
    Angle,
    AngularVelocity,
    Density,
    Force,
    Length,
    Number,
    Pressure,
    Time,
    TimeTable,
    Velocity,
    number_in_time,
    problems_in_time,
    quantity,
    vector_in_time,
)

__all__ = [
    "Acceleration",
    "Angle",
    "AngularVelocity",
    "Density",
    "Force",
    "Length",
    "Number",
    "Pressure",
    "Time",
    "TimeTable",
    "Velocity",
    "number_in_time",
    "problems_in_time",
    "quantity",
    "vector_in_time",
]
