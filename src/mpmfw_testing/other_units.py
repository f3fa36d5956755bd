"""The options of a plug-in in other units of length, time and density, by the units that its model says."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from mpmfw.plugin.discovery import options_of
from mpmfw.units import powers_of
from mpmfw_testing.subject import Subject


def factor_of(unit: str, length: float = 1.0, time: float = 1.0, density: float = 1.0) -> float:
    """What a quantity is multiplied by where lengths, times and densities are.

    Raises
    ------
    ValueError
        ``unit`` is none.
    """
    mass, extent, duration = powers_of(unit)
    return float((density * length**3) ** mass * length**extent * time**duration)


def options_in_units(subject: Subject, units: Mapping[str, float]) -> dict[str, Any]:
    """Return the options that have a unit, times its factor; tables in time stay."""
    if subject.plugin is None or not options_of(subject.plugin):
        return {}
    made = subject.make()
    options = getattr(made, "options", made)
    schema = type(options).model_json_schema()
    found: dict[str, Any] = {}
    for name, field in schema.get("properties", {}).items():
        said, value = set(_units(field)), getattr(options, name)
        if len(said) == 1 and value is not None:
            factor = factor_of(said.pop(), **units)
            if factor != 1.0:
                found[name] = _times(value, factor)
    return found


def _units(field: Any) -> Iterator[str]:
    """All units in the schema of one option."""
    if isinstance(field, Mapping):
        if isinstance(field.get("unit"), str):
            yield field["unit"]
        for value in field.values():
            yield from _units(value)
    elif isinstance(field, list):
        for value in field:
            yield from _units(value)


def _times(value: Any, factor: float) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float | list | tuple):
        return value
    return (
        type(value)(_times(each, factor) for each in value)
        if isinstance(value, list | tuple)
        else value * factor
    )
