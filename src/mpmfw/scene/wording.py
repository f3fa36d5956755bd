"""Errors of pydantic as problems of a scene: one a key, with what was expected in words, from annotations."""

from __future__ import annotations

import enum
import pathlib
import types
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo

from mpmfw.errors import SceneError
from mpmfw.geometry.discretise import geometry_class
from mpmfw.plugin.checks import distribution_text
from mpmfw.plugin.discovery import available, nearest, one_of
from mpmfw.scene.problem import Path, Problem


def problems_of(
    error: ValidationError,
    model: type[BaseModel],
    data: Any,
    prefix: Path = (),
    also_valid: tuple[str, ...] = (),
) -> list[Problem]:
    """Return problems of ``data`` at ``prefix`` of the scene; ``also_valid`` keys are another model's."""
    found: dict[Path, list[Any]] = {}
    for item in error.errors(include_url=False):
        found.setdefault(_data_path(item["loc"], data, item["type"]), []).append(item)
    # pydantic counts the valid entries of an array alone, and calls one with a wrong entry too short
    return [
        _problem(items, path, model, data, prefix, also_valid)
        for path, items in found.items()
        if items[0]["type"] != "too_short"
        or all(other[: len(path)] != path for other in found if other != path)
    ]


def _data_path(loc: tuple[str | int, ...], data: Any, kind: str) -> Path:
    """The location without the names of alternatives that pydantic puts between the keys."""
    path: list[str | int] = []
    for depth, part in enumerate(loc):
        try:
            data = data[part]
            path.append(part)
        except (TypeError, LookupError):
            if kind == "missing" and depth == len(loc) - 1:
                path.append(part)
    return tuple(path)


def _problem(
    items: list[Any],
    path: Path,
    model: type[BaseModel],
    data: Any,
    prefix: Path,
    also_valid: tuple[str, ...],
) -> Problem:
    item, where, hints = items[0], prefix + path, hints_at(model, path, data)
    expectation = expected(hints)
    match item["type"]:
        case "extra_forbidden":
            keys = [key for one in models_in(hints_at(model, path[:-1], data)) for key in one.model_fields]
            return unknown_key(where, [*keys, *also_valid])
        case "missing":
            return Problem(where, _join("missing", expectation), "missing", expected=expectation)
        case "union_tag_not_found" | "union_tag_invalid":
            names = [str(tag) for one in models_in(hints) if (tag := tag_of(one))]
            if path[-1:] == ("geometry",):
                names = list(dict.fromkeys([*names, *available("geometry")]))
            key = (*where, item["ctx"]["discriminator"].strip("'"))
            if item["type"] == "union_tag_invalid":
                return unknown_name(key, item["ctx"]["tag"], names)
            return Problem(key, f"missing; expected one of {', '.join(names)}", "missing")
        case "literal_error" | "enum" if isinstance(item["input"], str):
            if choices := [one for hint in hints for one in choices_of(hint) if isinstance(one, str)]:
                return unknown_name(where, item["input"], choices)
    value = item["input"]
    return Problem(where, _value_message(item, expectation), value=value, expected=expectation)


def unknown_key(path: Path, valid: list[str]) -> Problem:
    """Return the problem of an unknown key, with the nearest valid one, or all if none is near."""
    close = nearest(str(path[-1]), valid)
    listed = f"valid keys: {', '.join(dict.fromkeys(valid))}" if valid else "no key is valid here"
    hint = f"did you mean '{close}'?" if close else listed
    return Problem(path, f"unknown key; {hint}", "unknown", close, expected=", ".join(dict.fromkeys(valid)))


def unknown_name(path: Path, given: str, valid: list[str], what: str = "") -> Problem:
    """Return the problem of a name that is not valid; the message begins with ``what``."""
    close, listed = nearest(given, valid), one_of(valid)
    hint = f"did you mean '{close}'? ({listed})" if close else f"expected {listed}"
    message = f"{what}'{given}' is unknown; {hint}"
    return Problem(path, message, suggestion=close, value=given, expected=listed)


def _value_message(item: Any, expectation: str) -> str:
    limits = {"greater_than": ("gt", "greater than"), "greater_than_equal": ("ge", "at least")}
    limits |= {"less_than": ("lt", "less than"), "less_than_equal": ("le", "at most")}
    kind = item["type"]
    if kind == "value_error":
        text = str(item["ctx"]["error"]).split("; expected")[0]
        return _join(text, expectation if isinstance(item["input"], str | bool) else "")
    if kind in limits:
        key, words = limits[kind]
        return _join(f"must be {words} {item['ctx'][key]:g}, not {shown(item['input'])}", expectation)
    if kind == "finite_number":
        return _join(f"{item['input']} is not finite", expectation)
    if kind == "too_short" and isinstance(item["input"], dict):
        return "is empty; expected at least one table in it, of any name"
    if kind in ("too_short", "too_long"):
        bound = f"at least {item['ctx']['min_length']}" if kind == "too_short" else item["ctx"]["max_length"]
        return _join(f"has {len(item['input'])} entries, not {bound}", expectation)
    names = {**TYPES, bool: "a boolean", list: "an array", dict: "a table"}
    given = names.get(type(item["input"]), f"a {type(item['input']).__name__}")
    return _join(f"{shown(item['input'])} is {given}", expectation)


def _join(what: str, expectation: str) -> str:
    return f"{what}; expected {expectation}" if expectation else what


def shown(value: Any) -> str:
    """Return a value as TOML, shortened."""
    text = {True: "true", False: "false"}[value] if isinstance(value, bool) else repr(value)
    return text if len(text) <= 60 else text[:57] + "…"


class _NoOptions(BaseModel):
    """Stand-in for the model of a plug-in without options."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def with_options(
    plugin: type[Any], options: Mapping[str, Any], path: Path, core_keys: tuple[str, ...] = ()
) -> tuple[BaseModel | None, list[Problem]]:
    """Return a plug-in's validated options, or the problems of options at ``path`` of the scene."""
    model: Any = getattr(plugin, "Options", _NoOptions)
    try:
        if not (isinstance(model, type) and issubclass(model, BaseModel)):
            raise TypeError(f"expected a pydantic model, found {shown(model)}")
        return model.model_validate(dict(options)), []
    except ValidationError as error:
        return None, problems_of(error, model, options, path, core_keys)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a stranger's validators may raise anything
        text = f"Options of plug-in '{plugin.name}' of {distribution_text(plugin)}"
        return None, [Problem(path, f"{text} cannot judge them: {type(error).__name__}: {error}")]


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
