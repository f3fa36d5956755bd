"""Quantities: a bare number in SI, or a string with a unit ("6 MPa", "60 deg", "2 mm"); values in time.

Every physical key of a scene is annotated with one of the types below. The unit stands in the field's
metadata, so that the JSON schema, the messages and the documentation name the same one.
"""

from __future__ import annotations

import functools
import itertools
import math
import re
from collections.abc import Callable, Iterator, Sequence
from typing import Annotated, Any, Union

import numpy as np
import numpy.typing as npt
from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Strict, Tag

#: A quantity that is not zero has a magnitude between one over this and this, in SI: products of four of
#: them, such as an energy, then stay within what a number of double precision holds (1e-308 to 1e+308).
LARGEST = 1e60

_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*")
_FACTOR = r"[^\W\d]+[²³]?(?:(?:\^|\*\*)-?[0-9])?"
_UNIT = re.compile(rf"%|°|(?:1?\s*/\s*)?{_FACTOR}(?:\s*[*/·\s]\s*{_FACTOR})*")

#: Units that are read without pint, whose import takes a second: the SI unit that each is a
#: multiple of, and the factor, whose product with a number is the one that pint gives to the last digit.
_COMMON = {
    f"{prefix}{unit}": (unit, factor)
    for unit in ("m", "s", "Pa")
    for prefix, factor in {
        "": 1.0,
        "G": 1e9,
        "M": 1e6,
        "k": 1e3,
        "c": 1e-2,
        "m": 1e-3,
        "u": 1e-6,
        "µ": 1e-6,
    }.items()
} | {"deg": ("rad", math.pi / 180.0), "%": ("1", 0.01)}

#: Units that mean different things to different readers; pint takes the American one.
_AMBIGUOUS = {
    r"(?:kilo|mega|[kMG])?tons?": "tonne or short_ton",
    r"tons?_force|force_tons?": "tf or short_ton_force",
    r"hundredweights?|cwt": "short_hundredweight or long_hundredweight",
}

#: Characters of the longest text that is read as a quantity.
_LONGEST = 80


@functools.cache
def _registry() -> Any:
    """The pint registry, built at first use: most scenes give bare numbers and common units and never pay
    for it.
    """
    import pint

    return pint.UnitRegistry()


def to_si(value: object, unit: str) -> object:
    """Return ``value`` in ``unit``; numbers pass through, of strings a number and a unit are read.

    Nothing is evaluated: ``"1/2 m"`` and ``"(1 + 1) m"`` are refused. A ValueError refuses booleans and
    strings that are not quantities, or of another dimension than ``unit``.
    """
    if isinstance(value, bool):
        raise ValueError(f"{str(value).lower()} is a boolean; expected a number or a string {_example(unit)}")
    if not isinstance(value, str):
        return value
    if not value.strip():
        raise ValueError(f"an empty string is not a quantity; expected a number or a string {_example(unit)}")
    number = _NUMBER.match(value[: _LONGEST + 1])
    given = value[number.end() :].strip() if number else ""
    if number is None or len(value) > _LONGEST or (given and not _UNIT.fullmatch(given)):
        raise ValueError(f"{_shown(value)} is not a quantity; expected a number or a string {_example(unit)}")
    if not given and unit not in ("1", "rad"):
        raise ValueError(f"{value!r} has no unit: give a bare number (SI) or a quantity in {unit}")
    return _converted(float(number.group(1)), given, unit, value) if given else float(number.group(1))


def _converted(number: float, given: str, unit: str, text: str) -> float:
    common, factor = _COMMON.get(given, ("", 0.0))
    if common == unit:
        return number * factor
    import pint

    for word in re.findall(r"[^\W\d]+", given):
        for pattern, choice in _AMBIGUOUS.items():
            if re.fullmatch(pattern, word):
                raise ValueError(f"{text!r}: '{word}' is ambiguous: {choice}?")
    try:
        quantity = _registry().Quantity(number, _registry().parse_units(given))
        if quantity.dimensionless and unit not in ("1", "rad"):
            raise ValueError(f"{text!r} has no unit: give a bare number (SI) or a quantity in {unit}")
        # pint takes an angle for a number, a slope for an angle, and a cycle for a radian
        is_angle = "radian" in str(quantity.to_base_units().units)
        if quantity.dimensionless and is_angle != (unit == "rad"):
            raise ValueError(
                f"{text!r} is a number, no angle; expected one such as '30 deg'"
                if unit == "rad"
                else f"{text!r} is an angle; expected a number"
            )
        if unit == "rad/s" and "hertz" in str(quantity.units):
            raise ValueError(f"{text!r}: of an angular velocity Hz is ambiguous: turn/s or rad/s?")
        return float(quantity.to("dimensionless" if unit == "1" else unit).magnitude)
    except pint.DimensionalityError as error:
        raise ValueError(f"{text!r} is not convertible to {unit}") from error
    except (pint.PintError, AttributeError, TypeError, SyntaxError, ArithmeticError) as error:
        raise ValueError(
            f"{text!r} is not a quantity; expected a number or a string {_example(unit)}"
        ) from error


def _shown(text: str) -> str:
    """A text as a message quotes it."""
    return repr(text) if len(text) <= _LONGEST else f"{text[:20]!r}…"


def _example(unit: str) -> str:
    """``such as '1.5 m'``; a dimensionless quantity may be a percentage."""
    return f"such as '{'5 %' if unit == '1' else f'1.5 {unit}'}'"


def within_range(value: float) -> float:
    """Return the value; a ValueError if products of such values are out of the range of numbers."""
    if value != 0.0 and math.isfinite(value) and not 1.0 / LARGEST <= abs(value) <= LARGEST:
        raise ValueError(
            f"{value!r} is out of range: a magnitude is 0 or from {1.0 / LARGEST:g} to {LARGEST:g} in SI "
            "units"
        )
    return value


def quantity(unit: str) -> Any:
    """The pydantic annotation of a number measured in ``unit``."""
    return Annotated[
        float,
        BeforeValidator(functools.partial(to_si, unit=unit)),
        AfterValidator(within_range),
        Field(allow_inf_nan=False, json_schema_extra={"unit": unit}),
    ]


Length = quantity("m")
Time = quantity("s")
Velocity = quantity("m/s")
AngularVelocity = quantity("rad/s")
Acceleration = quantity("m/s^2")
Angle = quantity("rad")
Pressure = quantity("Pa")
Force = quantity("N")
Torque = quantity("N m")
Density = quantity("kg/m^3")
Frequency = quantity("Hz")
Mass = quantity("kg")
Inertia = quantity("kg m^2")
Number = quantity("1")


class TimeTable:
    """Rows (t, values …), (m, 1 + n): linear in time [s] between them, constant outside."""

    def __init__(self, rows: Sequence[Sequence[float]]) -> None:
        table = np.array(rows, dtype=float)
        self.times, self.values = table[:, 0], np.ascontiguousarray(table[:, 1:])

    @classmethod
    def constant(cls, values: Sequence[float]) -> TimeTable:
        """Return a table with the same ``values`` (n,) at all times."""
        return cls([(0.0, *values)])

    @classmethod
    def of(cls, given: Any) -> TimeTable:
        """Return the table of a scene's key: a number, a vector (n,), or rows of a time [s] and either."""
        if not isinstance(given, tuple):
            return cls.constant([given])
        return cls(given) if isinstance(given[0], tuple) else cls.constant(given)

    def at(self, time: float) -> npt.NDArray[np.float64]:
        """Values (n,) at a ``time`` [s]."""
        if len(self.times) == 1:
            return np.asarray(self.values[0])
        return np.array([np.interp(time, self.times, column) for column in self.values.T])

    def mean(self, time: float, dt: float) -> npt.NDArray[np.float64]:
        """Mean of the values (n,) from ``time`` over ``dt`` [s]."""
        if len(self.times) == 1 or dt == 0.0:
            return self.at(time)
        within = self.times[(self.times > time) & (self.times < time + dt)]
        times = np.array([time, *within, time + dt])
        values = np.array([self.at(each) for each in times])
        return np.asarray(np.diff(times) @ (0.5 * (values[1:] + values[:-1])) / (times[-1] - times[0]))


def alternatives(form_of: Callable[[Any], str], **forms: Any) -> Any:
    """Return the annotation of a value in one of several ``forms``; ``form_of`` names the form of a value."""
    tagged = tuple(Annotated[annotation, Tag(name)] for name, annotation in forms.items())
    return Annotated[Union[tagged], Discriminator(form_of)]  # noqa: UP007


def array_of(entry: Any, least: int, most: int | None = None) -> Any:
    """Return the annotation of an array of ``least`` entries or more, a list or a tuple."""
    return Annotated[tuple[entry, ...], Strict(False), Field(min_length=least, max_length=most)]


def number_in_time(quantity: Any) -> Any:
    """Return the annotation of a ``quantity`` that is constant, or rows (t, value)."""
    row = Annotated[tuple[Time, quantity], Strict(False)]  # type: ignore[valid-type]
    return alternatives(array_or_single, single=quantity, array=array_of(row, 2))


def vector_in_time(quantity: Any) -> Any:
    """Return the annotation of a vector of a ``quantity``: constant, or rows (t, x, y[, z])."""
    vector, rows = array_of(quantity, 2, 3), array_of(row_in_time(quantity), 2)
    return alternatives(_vector_or_rows, vector=vector, rows=rows)


def axial_in_time(quantity: Any) -> Any:
    """Return the annotation of a ``quantity`` about axes: a number in 2D, a vector in 3D; or rows in time."""
    vector, row = array_of(quantity, 3, 3), row_in_time(quantity, in_plane=1)
    return alternatives(axial_form, single=quantity, vector=vector, rows=array_of(row, 2))


def row_in_time(quantity: Any, in_plane: int = 2) -> Any:
    """Return the annotation of a row (t, x, y, z) of a ``quantity``, or of fewer components ``in_plane``."""
    short, long = (tuple[(Time, *[quantity] * count)] for count in (in_plane, 3))  # type: ignore[misc, valid-type]
    two, three = Annotated[short, Strict(False)], Annotated[long, Strict(False)]
    return alternatives(length_of_row, two=two, three=three)


def problems_in_time(given: Any, components: int) -> Iterator[tuple[tuple[int, ...], str]]:
    """Yield problems of a number, a vector or rows in time, with the index of a row.

    Every row, or the vector, must have so many ``components``."""
    if not isinstance(given, tuple):
        return
    if not isinstance(given[0], tuple):
        if len(given) != components:
            yield (), wrong_length(len(given), components)
        return
    for index, row in enumerate(given):
        if len(row) != components + 1:
            yield (index,), f"has {len(row)} entries; expected the time and {components} components"
    for index, (before, after) in enumerate(itertools.pairwise(given)):
        if after[0] <= before[0]:
            yield (index + 1,), f"times must increase, but {after[0]:g} s follows {before[0]:g} s"


def wrong_length(given: int, dim: int) -> str:
    """``has 3 entries; expected 2, because the grid is 2D``."""
    return f"has {given} entries; expected {dim}, because the grid is {dim}D"


def array_or_single(value: Any) -> str:
    """Return a tag, so that one branch of a union complains and not all of them."""
    return "array" if isinstance(value, list | tuple) else "single"


def length_of_row(value: Any) -> str:
    """Return a tag of rows with a time and three components, or fewer."""
    return "three" if isinstance(value, list | tuple) and len(value) == 4 else "two"


def axial_form(value: Any) -> str:
    """Return a tag of a number, a vector, or rows in time."""
    return _vector_or_rows(value) if isinstance(value, list | tuple) else "single"


def _vector_or_rows(value: Any) -> str:
    rows = isinstance(value, list | tuple) and len(value) > 0 and isinstance(value[0], list | tuple)
    return "rows" if rows else "vector"
