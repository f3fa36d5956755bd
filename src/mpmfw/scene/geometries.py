"""Geometries of other distributions in the JSON schema of scenes, which messages are made of as well."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from typing import Any

from mpmfw.errors import SceneError
from mpmfw.geometry.discretise import geometry_class
from mpmfw.scene.expectation import Schema


def with_geometries(schema: Schema, names: Iterable[str]) -> Schema:
    """The schema of scenes with these geometries among the alternatives; what cannot be imported is left
    out.
    """
    found = copy.deepcopy(schema)
    table = found["$defs"]["Body"]["properties"]["geometry"]
    for name in names:
        try:
            model = geometry_class(name)
        except SceneError:
            continue
        key = f"geometry.{name}"
        own = model.model_json_schema(ref_template=f"#/$defs/{key}.{{model}}")
        found["$defs"] |= {f"{key}.{inner}": one for inner, one in own.pop("$defs", {}).items()}
        found["$defs"][key] = own
        table["oneOf"].append({"$ref": f"#/$defs/{key}"})
        table["discriminator"]["mapping"][name] = f"#/$defs/{key}"
    return found


def strangers(schema: Schema, data: Any) -> list[str]:
    """Types of geometries in the ``data`` of a scene that its schema does not know."""
    bodies = data.get("bodies") if isinstance(data, Mapping) else None
    known = schema.get("$defs", {}).get("Body", {}).get("properties", {}).get("geometry", {})
    tables = (
        [body.get("geometry") for body in bodies.values() if isinstance(body, Mapping)]
        if isinstance(bodies, Mapping)
        else []
    )
    types = [table.get("type") for table in tables if isinstance(table, Mapping)] if known else []
    return sorted(
        {name for name in types if isinstance(name, str) and name not in known["discriminator"]["mapping"]}
    )
