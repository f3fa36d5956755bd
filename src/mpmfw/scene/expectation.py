"""What a key expects, in words, read from the JSON schema that the models themselves give.

Units and choices thus stand in one place, the models' annotations, for the schema and for every message.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, TypeAlias

from mpmfw.scene.locator import Path

Schema: TypeAlias = dict[str, Any]

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
}

_TYPES = {
    "string": "a string",
    "number": "a number",
    "integer": "an integer",
    "boolean": "true or false",
    "object": "a table",
    "array": "an array",
    "null": "",
}


def subschemas(root: Schema, path: Path, data: Any) -> list[Schema]:
    """All schemas that may hold at ``path`` of ``data``: several where alternatives stand side by side."""
    current = list(_alternatives(root, root, data))
    for part in path:
        data = _entry(data, part)
        current = [found for schema in current for found in _below(root, schema, part, data)]
    return current


def keys(schemas: list[Schema]) -> list[str]:
    """Keys that the tables may have."""
    return [key for schema in schemas for key in schema.get("properties", {})]


def expected(schemas: list[Schema]) -> str:
    """``a length in m, a number or a string such as '2 mm'``; empty if nothing is known."""
    phrases = dict.fromkeys(phrase for schema in schemas if (phrase := _phrase(schema)))
    return ", or ".join(phrases)


def _alternatives(root: Schema, schema: Schema, data: Any) -> Iterator[Schema]:
    """The schema with references followed and alternatives spread; a discriminated one follows the data."""
    if "$ref" in schema:
        yield from _alternatives(root, root["$defs"][schema["$ref"].rsplit("/", 1)[-1]], data)
    elif "discriminator" in schema:
        mapping = schema["discriminator"]["mapping"]
        tag = _entry(data, schema["discriminator"]["propertyName"])
        chosen = [{"$ref": mapping[tag]}] if isinstance(tag, str) and tag in mapping else schema["oneOf"]
        for branch in chosen:
            yield from _alternatives(root, branch, data)
    elif "anyOf" in schema or "oneOf" in schema:
        for branch in schema.get("anyOf") or schema["oneOf"]:
            yield from _alternatives(root, branch, data)
    else:
        yield schema


def _below(root: Schema, schema: Schema, part: str | int, data: Any) -> Iterator[Schema]:
    if isinstance(part, int):
        prefix = schema.get("prefixItems", [])
        inner = prefix[part] if part < len(prefix) else schema.get("items")
    else:
        inner = schema.get("properties", {}).get(part, schema.get("additionalProperties"))
    if isinstance(inner, dict):
        yield from _alternatives(root, inner, data)


def _entry(data: Any, part: str | int) -> Any:
    try:
        return data[part]
    except (TypeError, LookupError):
        return None


def as_written(schemas: list[Schema]) -> str:
    """`` such as { size = '2 mm' }`` of a table with so few keys that must be there that each has an example;
    else empty.
    """
    if len(schemas) != 1 or schemas[0].get("type") != "object":
        return ""
    required = schemas[0].get("required", [])
    units = [schemas[0]["properties"][key].get("unit") for key in required]
    if not units or any(unit not in _QUANTITIES for unit in units):
        return f" with {' and '.join(required)}" if required else ""
    keys = ", ".join(f"{key} = '{_QUANTITIES[unit][1]}'" for key, unit in zip(required, units, strict=True))
    return f" such as {{ {keys} }}"


def _phrase(schema: Schema) -> str:
    choices = schema.get("enum", [schema["const"]] if "const" in schema else [])
    if choices:
        texts = ["true" if choice is True else f"'{choice}'" for choice in choices]
        return texts[0] if len(texts) == 1 else f"one of {', '.join(texts)}"
    unit = schema.get("unit", "1")
    if unit in _QUANTITIES:
        what, example = _QUANTITIES[unit]
        return f"{what} in {unit}, a number or a string such as '{example}'"
    if unit != "1":
        return f"a quantity in {unit}, a number or a string such as '1.5 {unit}'"
    if schema.get("type") == "array":
        return _array_phrase(schema)
    return _TYPES.get(schema.get("type", ""), "")


def _array_phrase(schema: Schema) -> str:
    entries = schema.get("prefixItems") or [schema.get("items") or {}]
    least, most = schema.get("minItems", 0), schema.get("maxItems")
    count = f"{least} " if least == most and least else f"{least} to {most} " if least and most else ""
    units = [entry.get("unit") for entry in entries]
    if all(unit == units[0] for unit in units) and units[0] not in (None, "1"):
        _, example = _QUANTITIES.get(units[0], ("", f"1.5 {units[0]}"))
        return f"an array of {count}values in {units[0]}, each a number or a string such as '{example}'"
    choices = ", ".join(f"'{choice}'" for choice in entries[0].get("enum", []))
    return f"an array of {count}" + (f"of {choices}" if choices else "entries")
