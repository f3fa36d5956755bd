"""Quantities: a bare number in SI, or a string with a unit ("6 MPa", "60 deg", "2 mm").

Every physical key of a scene is annotated with one of the types below. The unit stands in the field's
metadata, so that the JSON schema, the messages and the documentation name the same one.
"""

from __future__ import annotations

import functools
from typing import Annotated, Any

from pydantic import BeforeValidator, Field


@functools.cache
def _registry() -> Any:
    """The pint registry, built at first use: most scenes give bare numbers and never pay for it."""
    import pint

    return pint.UnitRegistry()


def to_si(value: object, unit: str) -> object:
    """Return ``value`` in ``unit``; numbers pass through, strings are parsed with pint.

    Raises
    ------
    ValueError
        The value is a boolean, or a string that is no quantity or has another dimension than ``unit``.
    """
    if isinstance(value, bool):
        raise ValueError(f"{str(value).lower()} is a boolean; expected a number or a string {_example(unit)}")
    if not isinstance(value, str):
        return value
    if not value.strip():
        raise ValueError(f"an empty string is not a quantity; expected a number or a string {_example(unit)}")
    import pint

    try:
        quantity = _registry().Quantity(value)
        if quantity.dimensionless and unit not in ("1", "rad"):
            raise ValueError(f"{value!r} has no unit: give a bare number (SI) or a quantity in {unit}")
        return float(quantity.to("dimensionless" if unit == "1" else unit).magnitude)
    except pint.DimensionalityError as error:
        raise ValueError(f"{value!r} is not convertible to {unit}") from error
    except (pint.UndefinedUnitError, pint.PintError, AttributeError, TypeError, SyntaxError) as error:
        raise ValueError(
            f"{value!r} is not a quantity; expected a number or a string {_example(unit)}"
        ) from error


def _example(unit: str) -> str:
    """``such as '1.5 m'``; a dimensionless quantity may be a percentage."""
    return f"such as '{'5 %' if unit == '1' else f'1.5 {unit}'}'"


def quantity(unit: str) -> Any:
    """The pydantic annotation of a number measured in ``unit``."""
    return Annotated[
        float,
        BeforeValidator(functools.partial(to_si, unit=unit)),
        Field(allow_inf_nan=False, json_schema_extra={"unit": unit}),
    ]


Length = quantity("m")
Time = quantity("s")
Velocity = quantity("m/s")
AngularVelocity = quantity("rad/s")
Acceleration = quantity("m/s^2")
Angle = quantity("rad")
Pressure = quantity("Pa")
Density = quantity("kg/m^3")
Number = quantity("1")
