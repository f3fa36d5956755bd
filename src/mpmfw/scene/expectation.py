"""The expectation of a key in words, read from the annotations of the models."""

from __future__ import annotations

import enum
import pathlib
import types
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from mpmfw.errors import SceneError
from mpmfw.geometry.discretise import geometry_class
from mpmfw.scene.problem import Path

#: What is measured in a unit, and an example of it.
_QUANTITIES = {
    "m": ("a length", "2 mm"),
    "s": ("a time", "5 us"),
    "m/s": ("a velocity", "30 m/s"),
    "rad/s": ("an angular velocity", "2 rad/s"),
    "m/s^2": ("an acceleration", "9.81 m/s^2"),
    "rad": ("an angle", "60 deg"),
    "Pa": ("a pressure or modulus", "6 MPa"),
    "kg/m^3": ("a density", "1 g/cm^3"),
    "kg": ("a mass", "2 kg"),
    "kg m^2": ("a moment of inertia", "0.1 kg m^2"),
}
TYPES = {
    str: "a string",
    float: "a number",
    int: "an integer",
    bool: "true or false",
    pathlib.Path: "a string",
}


def hints_at(model: type[BaseModel], path: Path, data: Any) -> list[Any]:
    """Return the annotations that may hold at ``path`` of ``data``, several where there are alternatives."""
    hints: list[Any] = [model]
    for part in path:
        hints = [inner for one in hints for hint in _alternatives(one, data) for inner in _below(hint, part)]
        try:
            data = data[part]
        except (TypeError, LookupError):
            data = None
    return [hint for one in hints for hint in _alternatives(one, data)]


def models_in(hints: list[Any]) -> list[type[BaseModel]]:
    """Return the models among annotations."""
    return [hint for hint in hints if isinstance(hint, type) and issubclass(hint, BaseModel)]


def expected(hints: list[Any]) -> str:
    """Return ``a length in m, a number or a string such as '2 mm'``; empty if nothing is known."""
    return ", or ".join(dict.fromkeys(phrase for hint in hints if (phrase := _phrase(hint))))


def choices_of(hint: Any) -> tuple[Any, ...]:
    """Return the values that a ``Literal`` or an ``Enum`` allows; none of any other annotation."""
    if isinstance(hint, type) and issubclass(hint, enum.Enum):
        return tuple(member.value for member in hint)
    return get_args(hint) if get_origin(hint) is Literal else ()


def tag_of(model: type[BaseModel]) -> Any:
    """Return the value of ``type`` that distinguishes a model from its alternatives; None of a single one."""
    return model.model_fields["type"].default if "type" in model.model_fields else None


def _alternatives(hint: Any, data: Any) -> Iterator[Any]:
    """Yield quantities, models and types in an annotation; of models with tags those that the data choose."""
    origin, args = get_origin(hint), get_args(hint)
    tag = data.get("type") if isinstance(data, Mapping) else None
    if origin is Annotated:
        quantities = [one for one in args[1:] if _unit(one)]
        yield from quantities[-1:] or _alternatives(args[0], data)
    elif isinstance(hint, FieldInfo) and not _unit(hint):
        yield from _alternatives(hint.annotation, data)
    elif origin in (Union, types.UnionType):
        found = [inner for arg in args for inner in _alternatives(arg, data)]
        rigid = [one for one in models_in(found) if "rigid" in one.model_fields]
        if rigid and isinstance(data, Mapping):
            found = rigid if "rigid" in data else [one for one in found if one not in rigid]
        if isinstance(tag, str) and any(map(tag_of, models_in(found))):
            chosen = [one for one in models_in(found) if tag_of(one) == tag]
            with suppress(SceneError):
                chosen = chosen or [geometry_class(tag)]
            found = chosen or found
        yield from found
    else:
        yield hint


def _below(hint: Any, part: str | int) -> list[Any]:
    if models_in([hint]):
        return [field] if (field := hint.model_fields.get(part)) else []
    args = get_args(hint)
    if get_origin(hint) is Literal or not args:
        return []
    if get_origin(hint) is tuple and isinstance(part, int) and args[-1] is not Ellipsis:
        return list(args[part : part + 1])
    return [args[0] if isinstance(part, int) else args[-1]]


def _unit(hint: Any) -> str:
    extra = hint.json_schema_extra if isinstance(hint, FieldInfo) else None
    return str(extra.get("unit", "")) if isinstance(extra, dict) else ""


def _phrase(hint: Any) -> str:
    args = get_args(hint)
    if unit := _unit(hint):
        what, example = _QUANTITIES.get(unit, ("a quantity", f"1.5 {unit}"))
        cells = " or '0.5 cells'" if "cells" in hint.json_schema_extra else ""
        text = f"{what} in {unit}, a number or a string such as '{example}'{cells}"
        return "a number" if unit == "1" else text
    if values := choices_of(hint):
        choices = ["true" if choice is True else f"'{choice}'" for choice in values]
        return choices[0] if len(choices) == 1 else f"one of {', '.join(choices)}"
    if get_origin(hint) is tuple:
        return f"an array, each entry {expected(list(_alternatives(args[0], None)))}"
    if get_origin(hint) is list:
        return "an array"
    if models_in([hint]):
        required = [key for key, field in hint.model_fields.items() if field.is_required()]
        return f"a table with {' and '.join(required)}" if required else "a table"
    return TYPES.get(hint, "a table" if args else "")
