"""Overrides of single keys: ``grid.cell_size = 0.2``, ``bodies.plane.sides[0].fixed = true``."""

from __future__ import annotations

import copy
import re
import tomllib
from collections.abc import Mapping
from typing import Any

from mpmfw.plugin.discovery import nearest
from mpmfw.scene.problem import Path, Problem, dotted

_PART = re.compile(r'"((?:\\.|[^"\\])*)"|([^."\[\]\s]+)|\[(\d+)\]')

#: Tables whose sub-tables a scene names: an override goes into an existing one and makes none by accident.
_NAMED_TABLES = ("bodies", "materials", "loads", "boundaries", "outputs")


def parse_path(key: str) -> Path:
    """Return the path of a key such as ``a.pairs[0]."b c"``; raise a ValueError for other text."""
    parts: list[str | int] = []
    at = 0
    while at < len(key):
        separator = bool(parts) and key[at] == "."
        match = _PART.match(key, at + separator)
        if match is None or (parts and not separator and match.group(3) is None):
            parts.clear()
            break
        quoted, bare, index = match.groups()
        name = bare if bare is not None else re.sub(r"\\(.)", r"\1", quoted or "")
        parts.append(name if index is None else int(index))
        at = match.end()
    if not parts or isinstance(parts[0], int):
        example = "grid.cell_size or contact.pairs[0].friction"
        raise ValueError(f"{key!r} is not a key; write it as in {example}")
    return tuple(parts)


def parse_value(text: str) -> Any:
    """Return a TOML value (``0.2``, ``true``, ``[1, 2]``), or the text itself if it is none (``2 mm``)."""
    try:
        document = tomllib.loads(f"value = {text}")
    except (tomllib.TOMLDecodeError, RecursionError):
        return text
    return document["value"] if len(document) == 1 else text


def merge(mapping: Mapping[str, Any], overrides: Mapping[str, Any]) -> tuple[dict[str, Any], list[Problem]]:
    """Return a copy of the scene's mapping with all overrides, and problems of those that do not fit."""
    merged: dict[str, Any] = copy.deepcopy(dict(mapping))
    problems = []
    for key, value in overrides.items():
        try:
            path = parse_path(key)
            _put(merged, path, copy.deepcopy(value))
        except (ValueError, LookupError) as error:
            problems.append(Problem((), str(error.args[0]), override=key))
    return merged, problems


def _put(table: dict[str, Any], path: Path, value: Any) -> None:
    """Set the value at the path; create optional tables on the way."""
    at: Any = table
    for depth, part in enumerate(path[:-1]):
        if isinstance(at, dict) and part not in at:
            if depth == 1 and path[0] in _NAMED_TABLES:
                close = nearest(str(path[1]), at)
                hint = f"did you mean '{close}'?" if close else f"the scene has {', '.join(at) or 'none'}"
                raise LookupError(f"{dotted(path[:2])}: no such name; {hint}")
            at[str(part)] = {}
        at = _entry(at, part, path[:depth])
    if not (isinstance(at, dict) and isinstance(path[-1], str)):
        _entry(at, path[-1], path[:-1])
    at[path[-1]] = value


def _entry(at: Any, part: str | int, above: Path) -> Any:
    if isinstance(at, dict) and isinstance(part, str):
        return at[part]
    if isinstance(at, list) and isinstance(part, int) and part < len(at):
        return at[part]
    if isinstance(at, list):
        raise LookupError(f"{dotted(above)} has {len(at)} entries, chosen by an index from [0]")
    kind = "array" if isinstance(part, int) else "table"
    raise LookupError(f"{dotted(above)} is not a {kind}: it has no entries")
