"""Errors of pydantic in the words of a scene: one problem a key, with what was expected there."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from mpmfw.plugin.checks import distribution_text
from mpmfw.plugin.discovery import available, nearest, one_of
from mpmfw.scene.cells import may_be_in_cells
from mpmfw.scene.expectation import Schema, as_written, expected, keys, subschemas
from mpmfw.scene.geometries import strangers, with_geometries
from mpmfw.scene.locator import Path
from mpmfw.scene.problem import Problem


def problems_of(
    error: ValidationError,
    model: type[BaseModel],
    data: Any,
    prefix: Path = (),
    also_valid: tuple[str, ...] = (),
) -> list[Problem]:
    """The problems that ``error`` lists, for ``data`` that stands at ``prefix`` of the scene.

    ``also_valid`` are keys of the same table that another model reads.
    """
    schema = _schema(model)
    if others := strangers(schema, data):
        schema = with_geometries(schema, others)
    found: dict[Path, list[Any]] = {}
    for item in error.errors(include_url=False):
        found.setdefault(_data_path(item["loc"], data, item["type"]), []).append(item)
    # pydantic counts the valid entries of an array alone, and calls one with a wrong entry too short
    found = {
        p: items for p, items in found.items() if items[0]["type"] != "too_short" or not _has_below(p, found)
    }
    return [_problem(items, path, schema, data, prefix, also_valid) for path, items in found.items()]


@functools.lru_cache(maxsize=32)
def _schema(model: type[BaseModel]) -> Schema:
    """The model's JSON schema, made once: many scenes may be judged after each other."""
    return model.model_json_schema()


def _has_below(path: Path, others: Iterable[Path]) -> bool:
    return any(len(other) > len(path) and other[: len(path)] == path for other in others)


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
    items: list[Any], path: Path, schema: Schema, data: Any, prefix: Path, also_valid: tuple[str, ...]
) -> Problem:
    item = items[0]
    schemas = subschemas(schema, path, data)
    where = prefix + path
    expectation = expected(schemas)
    if may_be_in_cells(where):
        expectation = expectation.replace("such as '2 mm'", "such as '2 mm' or '0.5 cells'")
    match item["type"]:
        case "extra_forbidden":
            return unknown_key(where, [*keys(subschemas(schema, path[:-1], data)), *also_valid])
        case "missing":
            message = _join("missing", expectation + as_written(schemas))
            return Problem(where, message, "missing", expected=expectation)
        case "union_tag_not_found":
            names = item["ctx"].get("discriminator", "'type'").strip("'")
            return Problem(
                (*where, names),
                f"missing; expected one of {', '.join(_types(schema, path, data))}",
                "missing",
            )
        case "union_tag_invalid":
            tag, tags = item["ctx"]["tag"], _types(schema, path, data)
            key = item["ctx"]["discriminator"].strip("'")
            return unknown_name((*where, key), tag, tags)
        case "literal_error" | "enum" if isinstance(item["input"], str):
            choices = [c for s in schemas for c in s.get("enum", [s.get("const")]) if isinstance(c, str)]
            if choices:
                return unknown_name(where, item["input"], choices)
    return Problem(where, _value_message(item, expectation), value=item["input"], expected=expectation)


def unknown_key(path: Path, valid: list[str]) -> Problem:
    """An unknown key, with the nearest valid one, or all of them where none is near."""
    close = nearest(str(path[-1]), valid)
    listed = f"valid keys: {', '.join(dict.fromkeys(valid))}" if valid else "no key is valid here"
    hint = f"did you mean '{close}'?" if close else listed
    return Problem(path, f"unknown key; {hint}", "unknown", close, expected=", ".join(dict.fromkeys(valid)))


def unknown_name(path: Path, given: str, valid: list[str], what: str = "") -> Problem:
    """Return the problem of a name that is none of the valid ones; ``what`` is said before it."""
    message, close = what + choice_message(given, valid), nearest(given, valid)
    return Problem(path, message, suggestion=close, value=given, expected=one_of(valid))


def choice_message(given: str, valid: list[str]) -> str:
    """``'uls' is unknown; did you mean 'usl'? (one of …)``."""
    close = nearest(given, valid)
    listed = one_of(valid)
    return f"'{given}' is unknown; " + (
        f"did you mean '{close}'? ({listed})" if close else f"expected {listed}"
    )


def _tags(schema: Schema, path: Path, data: Any) -> list[str]:
    """Values that tell the alternatives at ``path`` apart."""
    found = []
    for alternative in subschemas(schema, path, data):
        properties = alternative.get("properties", {}).values()
        found += [str(entry["const"]) for entry in properties if "const" in entry]
    return list(dict.fromkeys(found))


def _types(schema: Schema, path: Path, data: Any) -> list[str]:
    """As :func:`_tags`; of a body's geometry those of other distributions as well."""
    tags = _tags(schema, path, data)
    return list(dict.fromkeys([*tags, *available("geometry")])) if path[-1:] == ("geometry",) else tags


def _value_message(item: Any, expectation: str) -> str:
    """What is wrong with a value: the limit that it breaks, or its type."""
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
        return "is empty; expected at least one table in it, named as you like"
    if kind in ("too_short", "too_long"):
        return _join(f"has {len(item['input'])} entries", expectation)
    return _join(f"{shown(item['input'])} is {_type_name(item['input'])}", expectation)


def _join(what: str, expectation: str) -> str:
    return f"{what}; expected {expectation}" if expectation else what


def shown(value: Any) -> str:
    """A value as TOML writes it, shortened."""
    text = {True: "true", False: "false"}[value] if isinstance(value, bool) else repr(value)
    return text if len(text) <= 60 else text[:57] + "…"


def _type_name(value: Any) -> str:
    names = {
        bool: "a boolean",
        int: "an integer",
        float: "a number",
        str: "a string",
        list: "an array",
        dict: "a table",
    }
    return names.get(type(value), f"a {type(value).__name__}")


class _NoOptions(BaseModel):
    """Stands for the model of a plug-in that declares none."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def with_options(
    plugin: type[Any], options: Mapping[str, Any], path: Path, core_keys: tuple[str, ...] = ()
) -> tuple[BaseModel | None, list[Problem]]:
    """An instance of the plug-in's own model, or what is wrong with options that stand at ``path`` of the
    scene.
    """
    model: Any = getattr(plugin, "Options", _NoOptions)
    text = f"Options of plug-in '{plugin.name}' of {distribution_text(plugin)}"
    if not (isinstance(model, type) and issubclass(model, BaseModel)):
        return None, [Problem(path, f"{text}: expected a pydantic model, found {shown(model)}")]
    try:
        return model.model_validate(dict(options)), []
    except ValidationError as error:
        return None, problems_of(error, model, options, path, core_keys)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # a stranger's validators may raise anything
        message = f"{text} cannot judge them: {type(error).__name__}: {error}"
        return None, [Problem(path, message)]
