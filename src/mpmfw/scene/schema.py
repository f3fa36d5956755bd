"""JSON Schema of scenes, the option tables of all installed plug-ins included."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from mpmfw.errors import SceneError
from mpmfw.geometry.discretise import geometry_class
from mpmfw.plugin.discovery import Kind, available, load, only_bundled
from mpmfw.scene.options import NAMED
from mpmfw.scene.sources import walk
from mpmfw.scene.tables import Tables

_OPEN = "additionalProperties"
_LIMITS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scene; this imports every installed plug-in."""
    schema = Tables.model_json_schema()
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    schema["title"] = "Scene of mpmfw"
    for kind in ("shape", "contact"):
        table = schema["$defs"][kind.capitalize()]
        table["properties"]["method"]["enum"] = list(available(kind))
        for name in available(kind):
            table["properties"][name] = _options(schema, kind, name)
    for table, kind_of_model in zip(("Material", "Load", "Boundary", "Series"), NAMED.values(), strict=True):
        _add_models(schema, table, kind_of_model)
    for name in available("geometry"):
        if not only_bundled("geometry", name):
            with suppress(SceneError):  # it cannot be imported
                _add_geometry(schema, name)
    _allow_units(schema)
    return schema


def _allow_units(schema: dict[str, Any]) -> None:
    """Let quantities be strings with a unit as well, and name limits as in JSON Schema."""
    for _, part in walk(schema):
        if isinstance(part, dict) and "unit" in part and part.get("type") == "number":
            part["type"] = ["number", "string"]
            for ours, theirs in _LIMITS.items():
                if ours in part:
                    part[theirs] = part.pop(ours)


def _options(schema: dict[str, Any], kind: Kind, name: str) -> dict[str, Any]:
    plugin = load(kind, name)
    model = getattr(plugin, "Options", None)
    if model is None:
        return {"type": "object", _OPEN: False}
    prefix = f"{kind}.{name}."
    options = model.model_json_schema(ref_template=f"#/$defs/{prefix}{{model}}")
    for inner, definition in options.pop("$defs", {}).items():
        schema["$defs"][prefix + inner] = definition
    key = prefix + "Options"
    schema["$defs"][key] = {**options, "description": (plugin.__doc__ or "").strip().partition("\n")[0]}
    return {"$ref": f"#/$defs/{key}"}


def _add_models(schema: dict[str, Any], table: str, kind: Kind) -> None:
    core = schema["$defs"][table]
    alternatives = []
    for name in available(kind):
        reference = _options(schema, kind, name)["$ref"].rsplit("/", 1)[-1]
        own = schema["$defs"][reference]
        own["properties"] = {**core["properties"], **own.get("properties", {}), "model": {"const": name}}
        own["required"] = list(dict.fromkeys([*core["required"], *own.get("required", [])]))
        alternatives.append({"$ref": f"#/$defs/{reference}"})
    if alternatives:
        schema["$defs"][table] = {"oneOf": alternatives}


def _add_geometry(schema: dict[str, Any], name: str) -> None:
    key, table = f"geometry.{name}", schema["$defs"]["Body"]["properties"]["geometry"]
    own = geometry_class(name).model_json_schema(ref_template=f"#/$defs/{key}.{{model}}")
    schema["$defs"] |= {f"{key}.{inner}": one for inner, one in own.pop("$defs", {}).items()}
    schema["$defs"][key] = own
    table["oneOf"].append({"$ref": f"#/$defs/{key}"})
    table["discriminator"]["mapping"][name] = f"#/$defs/{key}"
