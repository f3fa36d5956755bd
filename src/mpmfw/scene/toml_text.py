"""Mappings as TOML text, so that results hold the scene as a document that runs again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from mpmfw.scene.problem import dotted


def toml_text(mapping: Mapping[str, Any]) -> str:
    """Return the mapping as a TOML document: values first, then a table for each sub-mapping."""
    lines: list[str] = []
    _table(lines, (), mapping)
    return "\n".join(lines).strip() + "\n"


def _table(lines: list[str], path: tuple[str, ...], mapping: Mapping[str, Any]) -> None:
    inner = {key: value for key, value in mapping.items() if isinstance(value, Mapping)}
    values = {key: value for key, value in mapping.items() if key not in inner}
    if path and (values or not inner):
        lines += ["", f"[{dotted(path)}]"]
    lines += [f"{dotted((key,))} = {value_text(value)}" for key, value in values.items()]
    for key, value in inner.items():
        _table(lines, (*path, key), value)


def value_text(value: Any) -> str:
    """Return one value as TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        # JSON's escapes are TOML's, except that TOML also wants DEL escaped
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list | tuple):
        return f"[{', '.join(value_text(item) for item in value)}]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{dotted((key,))} = {value_text(item)}" for key, item in value.items()) + "}"
    if isinstance(value, int | float):
        return repr(value).replace("e+", "e")
    return str(value)
